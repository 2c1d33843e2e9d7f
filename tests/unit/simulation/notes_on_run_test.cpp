#include "simulation/notes_on_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {
namespace {

/// A series of one column whose mean over all but the first fifth is the result.
struct Measured {
  Table series;
  std::vector<NamedEstimate> results;
  std::size_t left_out = 0;
};

Measured measured(std::vector<double> const& values, double error = 0.03) {
  Measured one;
  one.left_out = values.size() / 5;
  std::vector<std::uint64_t> steps;
  double sum = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    steps.push_back(100 * k);
    if (k >= one.left_out) sum += values[k];
  }
  double const mean = sum / static_cast<double>(values.size() - one.left_out);
  one.series.add_column("step", steps);
  one.series.add_column("pressure", values);
  one.results = {{"pressure", {.value = mean, .error = error}, ""}, {"other", {.value = 1.0, .error = 0.1}, ""}};
  return one;
}

std::vector<double> noise(std::size_t count) {
  RandomStream random(1, 0, 0, Purpose::model_start);
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) values.push_back(5.0 + random.normal());
  return values;
}

TEST(WithholdErrors, LeavesHonestOnesAlone) {
  Measured one = measured(noise(1000));
  EXPECT_TRUE(withhold_errors(one.series, one.left_out, one.results).empty());
  EXPECT_TRUE(one.results[0].estimate.error.has_value());
}

TEST(WithholdErrors, TakesAwayWhatTheSeriesContradictsAndSaysWhy) {
  std::vector<double> values = noise(1000);
  for (std::size_t k = 120; k < 190; ++k) values[k] += 2.0;
  Measured one = measured(values);
  double const mean = one.results[0].estimate.value;
  std::vector<Event> const notes = withhold_errors(one.series, one.left_out, one.results);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(to_text(notes[0]).find("no error is given for pressure: the samples that averages leave out differ from "),
            0U)
      << to_text(notes[0]);
  EXPECT_FALSE(one.results[0].estimate.error.has_value());
  EXPECT_EQ(one.results[0].estimate.value, mean);
  EXPECT_TRUE(one.results[1].estimate.error.has_value()) << "it is of another column";
}

TEST(WithholdErrors, SaysWhereARunIsTooShortForAViscosity) {
  // Two lags make the first value, and ten the first error.
  for (auto const& [samples, words] : std::vector<std::pair<int, std::string>>{
           {20,
            "no value is given for shear_viscosity, bulk_viscosity: averages keep 20 samples, and it takes 2 times "
            "observe.viscosity_lag"},
           {30,
            "no error is given for shear_viscosity, bulk_viscosity: averages keep 30 samples, and it takes 10 times "
            "observe.viscosity_lag"},
           {140, ""}}) {
    gridlock::Setup setup =
        set_up(SettingsFile::from_text("disks = { count = 64, packing_fraction = 0.3 }\nbox.edge = \"periodic\"\n"
                                       "engine = { kind = \"exact\", time_step = 0.01 }\nobserve = { every = 20, "
                                       "viscosity_lag = 12, equilibration = 0 }\n",
                                       "a"));
    gridlock::Run run(*setup.simulation,
                      {.stop_condition = {.step = static_cast<std::uint64_t>(20 * samples)}, .sample_every = 20});
    run.advance();
    std::string notes;
    for (Event const& note : run.record().notes) notes += to_text(note);
    EXPECT_EQ(notes.find(" is given for shear_viscosity") != std::string::npos, !words.empty()) << notes;
    EXPECT_NE(notes.find(words), std::string::npos) << notes;
  }
}

TEST(WithholdErrors, LookAtMeansAloneAndNotAtWhatGrows) {
  std::vector<double> values;
  for (int k = 0; k < 1000; ++k) values.push_back(0.01 * k);
  Measured one = measured(values);
  one.results[0].estimate.value = values.back();
  EXPECT_TRUE(withhold_errors(one.series, one.left_out, one.results).empty());
  EXPECT_TRUE(one.results[0].estimate.error.has_value());
  // The mean of the same would be none of an equilibrium.
  Measured mean = measured(values);
  EXPECT_EQ(withhold_errors(mean.series, mean.left_out, mean.results).size(), 1U);
}

std::vector<std::string> kinds_after(State start, RunSettings const& length) {
  Configuration configuration;
  configuration.engine.kind = "exact";
  configuration.run = length;
  configuration.observe.structure_every = 0;
  Setup setup = set_up(configuration, {.start = std::move(start)});
  Run run(*setup.simulation, plan_of(setup));
  run.advance();
  std::vector<std::string> kinds;
  for (Event const& note : run.record().notes) kinds.emplace_back(to_text(note.kind));
  return kinds;
}

State crystal_or_fluid(double packing_fraction) {
  State state = make_start(Box(1.2, 1.0, Edge::periodic),
                           {.count = 64, .packing_fraction = packing_fraction, .start = StartKind::triangular}, 3);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

bool has(std::vector<std::string> const& kinds, std::string const& kind) {
  return std::ranges::find(kinds, kind) != kinds.end();
}

TEST(NotesOnMotion, TellDisksThatHaveNotLeftTheirCages) {
  EXPECT_TRUE(has(kinds_after(crystal_or_fluid(0.74), {.collisions_per_disk = 200.0}), "disks_in_cages"));
  EXPECT_FALSE(has(kinds_after(crystal_or_fluid(0.3), {.collisions_per_disk = 200.0}), "disks_in_cages"));
  EXPECT_FALSE(has(kinds_after(crystal_or_fluid(0.74), {.collisions_per_disk = 5.0}), "disks_in_cages"))
      << "few collisions tell nothing";
}

TEST(NotesOnMotion, TellThatTimeHardlyMoves) {
  // Two disks fill the width of the box to the last digit but one.
  State state{.box = Box(1.0, 0.8, Edge::wall), .seed = 1};
  double const radius = 0.25 * (1.0 - 1e-9);
  state.agents.add(0.25, 0.4, 1.0, 0.0, radius, 1.0, 0, 0);
  state.agents.add(0.75, 0.4, -0.5, 0.0, radius, 1.0, 0, 0);
  std::vector<std::string> const kinds = kinds_after(state, {.collisions_per_disk = 1000.0});
  EXPECT_TRUE(has(kinds, "time_stands_still"));
  EXPECT_FALSE(has(kinds, "disks_in_cages")) << "said better";
  EXPECT_FALSE(has(kinds_after(crystal_or_fluid(0.74), {.collisions_per_disk = 200.0}), "time_stands_still"));
}

}  // namespace
}  // namespace gridlock
