#include "gridlock/simulation/run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/saturating.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "reference/hard_engines.hpp"

namespace gridlock {
namespace {

/// 40 steps between two samples, looked at after every step.
Setup setup_of(std::string const& engine) {
  Configuration configuration;
  configuration.disks = {.count = 100, .packing_fraction = 0.5};
  configuration.engine = {.kind = engine, .threads = 2};
  configuration.run.steps = 100;
  configuration.observe = {.every = 40, .structure_every = 0};
  return set_up(configuration);
}

struct WatchedRun {
  explicit WatchedRun(std::string const& engine) : setup(setup_of(engine)), plan(plan_of(setup)) {
    plan.seconds_per_look = 0.0;
  }
  gridlock::Setup setup;
  Simulation& simulation = *setup.simulation;
  RunPlan plan;
};

class RunOfEveryEngine : public testing::TestWithParam<std::string> {};

TEST_P(RunOfEveryEngine, IsStoppedWithinAChunkAndGoesOnToTheSameBits) {
  RunResult const whole = simulate(setup_of(GetParam()));
  WatchedRun watched(GetParam());
  gridlock::Run run(watched.simulation, watched.plan);
  EXPECT_EQ(run.advance([](Progress const& progress) { return progress.steps < 7; }), RunStatus::interrupted);
  EXPECT_EQ(watched.simulation.clock().step, 7U);
  EXPECT_EQ(run.advance([](Progress const& progress) { return progress.steps < 53; }), RunStatus::interrupted);
  EXPECT_EQ(watched.simulation.clock().step, 53U);
  EXPECT_EQ(run.advance(), RunStatus::finished);
  EXPECT_EQ(run.record().state_hash, whole.state_hash);
  EXPECT_EQ(std::get<std::vector<double>>(run.record().series.column("mean_displacement")),
            std::get<std::vector<double>>(whole.series.column("mean_displacement")));
}

TEST_P(RunOfEveryEngine, ReportsEveryStepOfAChunkOnce) {
  WatchedRun watched(GetParam());
  gridlock::Run run(watched.simulation, watched.plan);
  std::vector<std::uint64_t> seen;
  run.advance([&](Progress const& progress) {
    EXPECT_EQ(progress.clock.step, progress.steps);
    seen.push_back(progress.steps);
    return true;
  });
  ASSERT_EQ(seen.size(), 100U);
  for (std::size_t k = 0; k < seen.size(); ++k) EXPECT_EQ(seen[k], k + 1);
}

TEST_P(RunOfEveryEngine, CallsBackWithinAChunkWithItsDisksUpToDate) {
  RunResult const whole = simulate(setup_of(GetParam()));
  Configuration configuration = setup_of(GetParam()).configuration;
  configuration.run.steps = 13;
  std::uint64_t const hash_after_13 = simulate(set_up(configuration)).state_hash;
  WatchedRun watched(GetParam());
  gridlock::Run run(watched.simulation, watched.plan);
  int times = 0;
  Callback const callback{.is_due = [&](std::uint64_t steps) { return steps >= 13 && times == 0; },
                          .call =
                              [&](std::uint64_t steps) {
                                ++times;
                                EXPECT_EQ(steps, 13U);
                                EXPECT_EQ(watched.simulation.state_hash(), hash_after_13);
                              }};
  EXPECT_EQ(run.advance({}, callback), RunStatus::finished);
  EXPECT_EQ(times, 1);
  EXPECT_EQ(run.record().state_hash, whole.state_hash);
}

TEST_P(RunOfEveryEngine, ThrowsOnWhatTheListenerThrowsAndCanGoOn) {
  RunResult const whole = simulate(setup_of(GetParam()));
  WatchedRun watched(GetParam());
  gridlock::Run run(watched.simulation, watched.plan);
  EXPECT_THROW(run.advance([](Progress const& progress) {
    if (progress.steps == 5) throw std::logic_error("of the listener");
    return true;
  }),
               std::logic_error);
  EXPECT_EQ(watched.simulation.clock().step, 5U);
  EXPECT_EQ(run.advance(), RunStatus::finished);
  EXPECT_EQ(run.record().state_hash, whole.state_hash);
}

/// Looks at one step only.
class OneLook final : public Writer {
 public:
  explicit OneLook(std::uint64_t step) : step_(step) {}
  [[nodiscard]] bool is_due(std::uint64_t steps) const override { return steps == step_; }
  [[nodiscard]] std::uint64_t next_after(std::uint64_t steps) const override {
    return steps < step_ ? step_ : never_reached;
  }
  void write(Simulation const&, std::span<double const>) override { ++writes; }
  void serialize(Archive&) override {}
  int writes = 0;

 private:
  std::uint64_t step_;
};

TEST_P(RunOfEveryEngine, ThatStartsAtALaterStepEndsAfterTheLastFrameOfItsWriter) {
  gridlock::Setup const usual = setup_of(GetParam());
  State start = disks_of(usual);
  start.clock = {.step = 1000, .time = 1.5};
  gridlock::Setup const setup = set_up(usual.configuration, {.start = start});
  RunPlan const plan = plan_of(setup);
  Simulation& simulation = *setup.simulation;
  gridlock::Run run(simulation, plan);
  OneLook writer(10);
  run.add(writer);
  int asked = 0;
  Callback const watchdog{.is_due =
                              [&](std::uint64_t) {
                                if (++asked > 10'000) throw std::logic_error("the run makes no progress");
                                return false;
                              },
                          .call = {}};
  EXPECT_EQ(run.advance({}, watchdog), RunStatus::finished);
  EXPECT_EQ(simulation.clock().step, 1100U);
  EXPECT_EQ(writer.writes, 1);
}

INSTANTIATE_TEST_SUITE_P(Engines, RunOfEveryEngine, testing::ValuesIn(reference::hard_engine_kinds()),
                         [](testing::TestParamInfo<std::string> const& name) { return name.param; });

TEST(Run, ReportsNoSampleBeforeTheFirstAfterTheStart) {
  WatchedRun watched("stepped");
  gridlock::Run run(watched.simulation, watched.plan);
  run.advance([&](Progress const& progress) {
    // A report that comes with the end of a chunk comes before its sample.
    EXPECT_EQ(progress.last_sample.empty(), progress.steps <= 40) << progress.steps;
    if (!progress.last_sample.empty()) {
      EXPECT_GT(progress.last_sample[2], 0.0) << "the mean displacement";
    }
    return true;
  });
}

TEST(Run, OfExactIsInterruptedWithinALongStepAndTakesNoSampleThere) {
  auto const setup = [] {
    Configuration configuration;
    configuration.disks = {.count = 50, .packing_fraction = 0.5};
    configuration.engine = {.kind = "exact", .time_step = 1e3};
    configuration.run.steps = 3;
    configuration.observe = {.every = 1, .structure_every = 0};
    return set_up(configuration);
  };
  RunResult const whole = simulate(setup());
  gridlock::Setup const parts = setup();
  Simulation& simulation = *parts.simulation;
  RunPlan plan = plan_of(parts);
  plan.seconds_per_look = 0.0;
  gridlock::Run run(simulation, plan);
  int within_a_step = 0;
  while (run.advance([](Progress const&) { return false; }) == RunStatus::interrupted) {
    double const steps = simulation.clock().time / simulation.time_step();
    if (steps != std::floor(steps)) ++within_a_step;
  }
  EXPECT_GT(within_a_step, 3);
  EXPECT_EQ(run.record().state_hash, whole.state_hash);
  EXPECT_EQ(run.record().series.row_count(), whole.series.row_count());
  for (char const* column : {"time", "mean_displacement"}) {
    EXPECT_EQ(std::get<std::vector<double>>(run.record().series.column(column)),
              std::get<std::vector<double>>(whole.series.column(column)));
  }
}

TEST(Run, LooksNoMoreOftenThanPlanned) {
  WatchedRun watched("tiled");
  watched.plan.seconds_per_look = 3600.0;
  gridlock::Run run(watched.simulation, watched.plan);
  std::vector<std::uint64_t> seen;
  run.advance([&](Progress const& progress) {
    seen.push_back(progress.steps);
    return true;
  });
  // At the end of every chunk, and never within.
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{40, 80, 100}));
}

}  // namespace
}  // namespace gridlock
