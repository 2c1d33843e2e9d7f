// What the loop of a run promises about samples, averages, progress and time, with a simulation that only counts.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/run.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {
namespace {

/// Steps of half a unit of time that do nothing.
class Ticking final : public Simulation {
 public:
  explicit Ticking(Clock const& start = {}) : clock_(start) {}
  [[nodiscard]] Clock clock() const override { return clock_; }
  [[nodiscard]] double time_step() const override { return 0.5; }
  [[nodiscard]] Box const& box() const override { return box_; }
  [[nodiscard]] AgentsView view() const override { return agents_; }
  [[nodiscard]] std::uint64_t state_hash() const override { return clock_.step; }
  [[nodiscard]] std::vector<Count> counts() const override { return {}; }
  [[nodiscard]] std::vector<NamedColumn> columns_of_agents() override { return columns_of(agents_); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return agents_.release(); }
  void require_valid() const override {}
  void advance(StopCondition const& stop_condition) override {
    while (clock_.step < stop_condition.step && clock_.time < stop_condition.time) {
      ++clock_.step;
      clock_.time += time_step();
    }
  }
  void observe(std::unique_ptr<Observable> /*observable*/) override {}
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return {{"ticks", "", ""}}; }
  void sample(std::span<double> row, bool counts_for_average) override {
    row[0] = static_cast<double>(clock_.step);
    if (counts_for_average) averaged.push_back(clock_.step);
  }
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override { return {}; }
  void give_frame(UseFrame const& use) const override { use(*frame_source_of(box_, clock_, 0, agents_)); }
  void serialize(Archive& archive) override {
    archive.visit("step", clock_.step);
    archive.visit("time", clock_.time);
  }

  std::vector<std::uint64_t> averaged;  ///< the steps of the samples that count for averages

 private:
  Clock clock_;
  Box box_;
  Population<X, Y> agents_;
};

/// Three agents that walk to the right and count their steps.
struct Walkers {
  static constexpr std::string_view name = "walkers";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 2> events{"steps", "rests"};
  using Agents = Population<X, Y>;
  [[nodiscard]] double cutoff() const { return 0.1; }
  [[nodiscard]] double time_step() const { return 1.0; }
  void start(World<Walkers>& world) const {
    for (int n = 0; n < 3; ++n) world.agents.add(1.0 + n, 0.5);
  }
  void turn(Turn<Walkers>& self) const {
    self.count(0);
    self.move_by({0.5, 0.0});
  }
  void observe(World<Walkers> const& world, Observations& seen) const {
    auto const x = world.agents.column<X>();
    seen.add("least_x", *std::ranges::min_element(x));
    seen.add("most_x", *std::ranges::max_element(x));
  }
};

/// The results by name and the counts, as text.
std::string told_of(Simulation const& simulation) {
  std::string text;
  for (NamedEstimate const& named : simulation.results()) {
    text += named.name + " " + std::to_string(named.estimate.value) + ", ";
  }
  for (Count const& count : simulation.counts()) text += count.name + " " + std::to_string(count.value) + ", ";
  return text;
}

TEST(ModelSimulation, AveragesEveryObservationUnderItsNameAlsoWhereItResumes) {
  Box const box(20.0, 1.0, Edge::wall);
  RunPlan const plan{.stop_condition = {.step = 4}, .sample_every = 1};
  ModelSimulation<Walkers> whole({}, box, 1);
  gridlock::Run run(whole, plan);
  run.advance();
  // At steps 1 to 4 the last one is at 1.5, 2, 2.5 and 3, the first one is 2 ahead of it.
  EXPECT_EQ(told_of(whole),
            "agents 3.000000, least_x 2.250000, most_x 4.250000, mean_displacement 0.447214, "
            "mean_squared_displacement 4.000000, centre_displacement 0.447214, global_bond_orientation_order 1.000000, "
            "local_bond_orientation_order 1.000000, steps 12, rests 0, ");
  ModelSimulation<Walkers> begun({}, box, 1);
  gridlock::Run interrupted(begun, {.stop_condition = {.step = 2}, .sample_every = 1});
  interrupted.advance();
  ModelSimulation<Walkers> resumed({}, box, 1);
  from_checkpoint(to_checkpoint([&](Archive& archive) { begun.serialize(archive); }), "saved",
                  [&](Archive& archive) { resumed.serialize(archive); });
  EXPECT_EQ(told_of(resumed), told_of(begun));
}

using Steps = std::vector<std::uint64_t>;

Steps sampled(gridlock::Run const& run) { return std::get<Steps>(run.record().series.column("step")); }

TEST(RunLoop, ARunGivenInTimeEndsWithTheStepThatReachesItAndIsSampledThere) {
  Ticking simulation;
  gridlock::Run run(simulation, {.stop_condition = {.time = 3.5}, .sample_every = 5});
  EXPECT_EQ(run.advance(), RunStatus::finished);
  EXPECT_EQ(simulation.clock().step, 7U);
  EXPECT_EQ(sampled(run), (Steps{0, 5, 7}));
}

TEST(RunLoop, SamplesOfARunThatStartsLaterAreMultiplesFromItsStart) {
  Ticking simulation({.step = 1003, .time = 20.0});
  gridlock::Run run(simulation, {.stop_condition = {.step = 1026}, .sample_every = 10});
  run.advance();
  EXPECT_EQ(sampled(run), (Steps{1003, 1013, 1023, 1026}));
}

TEST(RunLoop, SamplesEvenInTheLogarithmAreThoseOfTheFormulaAndCountForNoAverage) {
  Ticking simulation({.step = 1000, .time = 20.0});
  gridlock::RunPlan const plan{.stop_condition = {.step = 1450}, .sample_every = 2, .samples_per_decade = 3};
  gridlock::Run run(simulation, plan);
  run.advance();
  // 10^(k/3) rounded, in pairs of steps: 1, 2, 5, 10, 22, 46, 100, 215.
  EXPECT_EQ(sampled(run), (Steps{1000, 1002, 1004, 1010, 1020, 1044, 1092, 1200, 1430, 1450}));
  EXPECT_EQ(simulation.averaged, Steps{});
  for (std::uint64_t per_decade : {1U, 7U, 10U, 1000U}) {
    gridlock::RunPlan const other{.sample_every = 1, .samples_per_decade = per_decade};
    std::uint64_t steps = 0;
    for (std::uint64_t k = 0; k <= 15 * per_decade; ++k) {
      auto const sample = static_cast<std::uint64_t>(
          std::floor(std::pow(10.0, static_cast<double>(k) / static_cast<double>(per_decade)) + 0.5));
      if (sample == steps) continue;
      ASSERT_EQ(other.next_sample(steps), sample) << k << " of " << per_decade;
      ASSERT_EQ(other.next_sample(sample - 1), sample);
      ASSERT_TRUE(other.is_sample_due(sample));
      steps = sample;
    }
  }
  gridlock::RunPlan const sparse{.sample_every = std::uint64_t{1} << 62, .samples_per_decade = 1};
  EXPECT_EQ(sparse.next_sample(std::uint64_t{1} << 62), std::numeric_limits<std::uint64_t>::max());
}

TEST(RunLoop, AveragesLeaveOutTheStartAndTheEquilibration) {
  Ticking whole;
  gridlock::Run(whole, {.stop_condition = {.step = 100}, .sample_every = 10}).advance();
  EXPECT_EQ(whole.averaged, (Steps{10, 20, 30, 40, 50, 60, 70, 80, 90, 100}));
  Ticking half;
  gridlock::Run(half, {.stop_condition = {.step = 100}, .sample_every = 10, .equilibration = 0.5}).advance();
  EXPECT_EQ(half.averaged, (Steps{60, 70, 80, 90, 100}));
  Ticking none;
  gridlock::Run run(none, {.stop_condition = {.step = 0}, .sample_every = 10});
  run.advance();
  EXPECT_EQ(sampled(run), (Steps{0}));
  EXPECT_EQ(none.averaged, Steps{}) << "the start of a run without a step is no average of anything";
}

TEST(RunLoop, TheShareThatIsDoneCountsFromTheStartOfTheRun) {
  auto const shares = [](StopCondition const& stop_condition) {
    Ticking simulation({.step = 1000, .time = 80.0});
    gridlock::Run run(simulation, {.stop_condition = stop_condition, .sample_every = 10, .seconds_per_look = 3600.0});
    std::vector<double> seen;
    run.advance([&](Progress const& progress) {
      seen.push_back(progress.fraction);
      return true;
    });
    return seen;
  };
  std::vector<double> const quarters{0.25, 0.5, 0.75, 1.0};
  EXPECT_EQ(shares({.step = 1040}), quarters);
  EXPECT_EQ(shares({.time = 100.0}), quarters);
}

TEST(RunLoop, TheRealTimeOfAResumedRunIncludesThatBefore) {
  Ticking first;
  RunPlan const plan{.stop_condition = {.step = 1'000'000'000}, .sample_every = 1000, .seconds_per_look = 0.0};
  gridlock::Run begun(first, plan);
  begun.advance([](Progress const& progress) { return progress.seconds < 0.02; });
  double const before = begun.record().seconds;
  ASSERT_GT(before, 0.0);
  std::string const saved = to_checkpoint([&](Archive& archive) { begun.serialize(archive); });
  Ticking second;
  gridlock::Run resumed(second, plan);
  from_checkpoint(saved, "saved", [&](Archive& archive) { resumed.serialize(archive); });
  EXPECT_EQ(resumed.record().seconds, before);
  resumed.advance([](Progress const&) { return false; });
  EXPECT_GE(resumed.record().seconds, before);
}

}  // namespace
}  // namespace gridlock
