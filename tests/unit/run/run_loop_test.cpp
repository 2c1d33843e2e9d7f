// What the loop of a run promises about samples, averages, progress and time, with an experiment that only counts.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "gridlock/io/checkpoint.hpp"
#include "gridlock/run/run.hpp"

namespace gridlock {
namespace {

/// Steps of half a unit of time that do nothing.
class Ticking final : public Experiment {
 public:
  explicit Ticking(Clock const& start = {}) : clock_(start) {}
  [[nodiscard]] Clock clock() const override { return clock_; }
  [[nodiscard]] double time_step() const override { return 0.5; }
  [[nodiscard]] std::size_t agents() const override { return 1; }
  [[nodiscard]] std::uint64_t state_hash() const override { return clock_.step; }
  [[nodiscard]] std::vector<Count> counts() const override { return {}; }
  void advance(Horizon const& horizon) override {
    while (clock_.step < horizon.step && clock_.time < horizon.time) {
      ++clock_.step;
      clock_.time += time_step();
    }
  }
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return {{"ticks", "", ""}}; }
  void sample(std::span<double> row, bool counts_for_average) override {
    row[0] = static_cast<double>(clock_.step);
    if (counts_for_average) averaged.push_back(clock_.step);
  }
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override { return {}; }
  [[nodiscard]] Frame frame() const override { return {}; }
  void carry(Archive& archive) override {
    archive.visit("step", clock_.step);
    archive.visit("time", clock_.time);
  }

  std::vector<std::uint64_t> averaged;  ///< the steps of the samples that count for averages

 private:
  Clock clock_;
};

using Steps = std::vector<std::uint64_t>;

Steps sampled(gridlock::Run const& run) { return std::get<Steps>(run.record().series.column("step")); }

TEST(RunLoop, ARunGivenInTimeEndsWithTheStepThatReachesItAndIsSampledThere) {
  Ticking experiment;
  gridlock::Run run(experiment, {.horizon = {.time = 3.5}, .sample_every = 5});
  EXPECT_EQ(run.go_on(), Ending::finished);
  EXPECT_EQ(experiment.clock().step, 7U);
  EXPECT_EQ(sampled(run), (Steps{0, 5, 7}));
}

TEST(RunLoop, SamplesOfARunThatStartsLaterAreMultiplesFromItsStart) {
  Ticking experiment({.step = 1003, .time = 20.0});
  gridlock::Run run(experiment, {.horizon = {.step = 1026}, .sample_every = 10});
  run.go_on();
  EXPECT_EQ(sampled(run), (Steps{1003, 1013, 1023, 1026}));
}

TEST(RunLoop, AveragesLeaveOutTheStartAndTheShareThatIsDiscarded) {
  Ticking whole;
  gridlock::Run(whole, {.horizon = {.step = 100}, .sample_every = 10}).go_on();
  EXPECT_EQ(whole.averaged, (Steps{10, 20, 30, 40, 50, 60, 70, 80, 90, 100}));
  Ticking half;
  gridlock::Run(half, {.horizon = {.step = 100}, .sample_every = 10, .discard = 0.5}).go_on();
  EXPECT_EQ(half.averaged, (Steps{60, 70, 80, 90, 100}));
  Ticking none;
  gridlock::Run run(none, {.horizon = {.step = 0}, .sample_every = 10});
  run.go_on();
  EXPECT_EQ(sampled(run), (Steps{0}));
  EXPECT_EQ(none.averaged, Steps{}) << "the start of a run without a step is no average of anything";
}

TEST(RunLoop, TheShareThatIsDoneCountsFromTheStartOfTheRun) {
  auto const shares = [](Horizon const& horizon) {
    Ticking experiment({.step = 1000, .time = 80.0});
    gridlock::Run run(experiment, {.horizon = horizon, .sample_every = 10, .seconds_per_look = 3600.0});
    std::vector<double> seen;
    run.go_on([&](Progress const& progress) {
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
  RunPlan const plan{.horizon = {.step = 1'000'000'000}, .sample_every = 1000, .seconds_per_look = 0.0};
  gridlock::Run begun(first, plan);
  begun.go_on([](Progress const& progress) { return progress.seconds < 0.02; });
  double const before = begun.record().seconds;
  ASSERT_GT(before, 0.0);
  std::string const saved = to_checkpoint([&](Archive& archive) { begun.carry(archive); });
  Ticking second;
  gridlock::Run resumed(second, plan);
  from_checkpoint(saved, "saved", [&](Archive& archive) { resumed.carry(archive); });
  EXPECT_EQ(resumed.record().seconds, before);
  resumed.go_on([](Progress const&) { return false; });
  EXPECT_GE(resumed.record().seconds, before);
}

}  // namespace
}  // namespace gridlock
