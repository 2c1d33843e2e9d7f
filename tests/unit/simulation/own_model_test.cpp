// A model of a program's own is run, interrupted, resumed and swept by its name, as those of the folder models/.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "gridlock/simulation/register_model.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "io/file.hpp"

namespace gridlock {
namespace {

/// Neither settings nor documentation nor observations.
struct Drifting {
  static constexpr std::string_view name = "drifting";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Drifting>& world) const {
    for (std::uint64_t n = 0; n < 50; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y);
    }
  }
  void turn(Turn<Drifting>& self) const {
    RandomStream random = self.random();
    self.move_by(0.05 * random.in_unit_disk());
    if (random.uniform() < 0.02) self.die();
    if (random.uniform() < 0.02) self.give_birth(self.position().x, self.position().y);
  }
};

/// Observes a number under a name that the summary has for something else.
struct Sowing {
  static constexpr std::string_view name = "sowing";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Sowing>& world) const { world.agents.add(0.5, 0.5); }
  void turn(Turn<Sowing>& /*self*/) const {}
  void observe(World<Sowing> const& /*world*/, Observations& seen) const { seen.add("seed", 2.5); }
};

SettingsFile settings() {
  return SettingsFile::from_text("model.kind = \"drifting\"\nrun.steps = 60\nobserve.every = 10\n", "own");
}

class OwnModel : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (known_models().find("drifting") == nullptr) register_model<Drifting>();
    if (known_models().find("sowing") == nullptr) register_model<Sowing>();
  }
  void SetUp() override {
    place_ = std::filesystem::temp_directory_path() / ("gridlock-own-model-" + std::to_string(getpid()));
    std::filesystem::remove_all(place_);
  }
  void TearDown() override { std::filesystem::remove_all(place_); }
  std::filesystem::path place_;
};

TEST_F(OwnModel, ResumesToTheBitsOfARunThatWasNeverInterrupted) {
  std::uint64_t const expected = run_in(place_ / "whole", set_up(settings())).state_hash;
  RunRecord const stopped = run_in(place_ / "stopped", set_up(settings()),
                                   {.on_progress = [](Progress const& progress) { return progress.steps < 20; }});
  ASSERT_EQ(stopped.status, RunStatus::interrupted);
  EXPECT_NE(stopped.state_hash, expected);
  EXPECT_EQ(resume_in(place_ / "stopped").state_hash, expected);
}

TEST_F(OwnModel, IsSwept) {
  SettingsFile const file = SettingsFile::from_text(
      "model.kind = \"drifting\"\nrun.steps = 10\n[sweep]\n\"run.seed\" = [1, 2]\n", "own sweep");
  EXPECT_EQ(plan_sweep(file).runs.size(), 2U);
}

TEST_F(OwnModel, AnObservationNamedLikeAnEntryOfTheSummaryIsThereAsItsMean) {
  run_in(place_, set_up(SettingsFile::from_text("model.kind = \"sowing\"\nrun.steps = 4\nrun.seed = 77\n", "own")));
  auto const summary = read_summary(place_);
  ASSERT_TRUE(summary);
  auto const mean = std::ranges::find(summary->results, "mean_seed", &NamedEstimate::name);
  ASSERT_NE(mean, summary->results.end());
  EXPECT_EQ(mean->estimate.value, 2.5);
  EXPECT_NE(read_file(place_ / "summary.json").find("\"seed\": 77,"), std::string::npos);
}

TEST_F(OwnModel, OfANameThatIsTakenIsRefused) { EXPECT_THROW(register_model<Drifting>(), Error); }

}  // namespace
}  // namespace gridlock
