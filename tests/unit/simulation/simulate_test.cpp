#include "gridlock/simulation/simulate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/saturating.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "reference/hard_engines.hpp"
#include "simulation/patient_engine.hpp"
#include "unit/io/temporary_directory.hpp"

namespace {

using namespace gridlock;

Configuration small() {
  Configuration configuration;
  configuration.disks = {.count = 64, .packing_fraction = 0.5};
  configuration.run.steps = 95;
  configuration.observe.every = 10;
  return configuration;
}

TEST(SetUp, FillsInWhatWasLeftOutSoThatItRunsAgainToTheBit) {
  gridlock::Setup const setup = set_up(Configuration{});
  EXPECT_EQ(setup.configuration.disks.count, 841U);
  EXPECT_EQ(setup.configuration.disks.packing_fraction, 0.5);
  EXPECT_EQ(setup.configuration.run.steps, 10'000U);
  EXPECT_EQ(setup.configuration.engine.speed, 1.0);
  EXPECT_EQ(hash(disks_of(set_up(setup.configuration))), hash(disks_of(setup)));
}

/// What set_up() says to a start file with this clock; empty where it takes it.
std::string refusal_of_start_at(Clock const& clock, std::string const& engine) {
  TemporaryDirectory const directory;
  State state = disks_of(set_up(small()));
  state.clock = clock;
  write_xyz(state, directory / "late.xyz");
  Configuration configuration;
  configuration.disks.file = (directory / "late.xyz").string();
  configuration.engine.kind = engine;
  try {
    static_cast<void>(set_up(configuration));
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

TEST(SetUp, RefusesAStartWhoseClockCannotCountOnWithTheNumbers) {
  for (std::string const& engine : reference::hard_engine_kinds()) {
    EXPECT_EQ(refusal_of_start_at({.step = 1'000'000, .time = 1e6}, engine), "");
    std::string const late_step = refusal_of_start_at({.step = never_reached - 5}, engine);
    EXPECT_NE(late_step.find("step 18446744073709551610 is too late"), std::string::npos) << late_step;
    EXPECT_NE(late_step.find("hint: set step"), std::string::npos) << late_step;
    std::string const late_time = refusal_of_start_at({.step = 3, .time = 1e17}, engine);
    EXPECT_NE(late_time.find("at time 1e+17 a clock cannot count steps of 0.0"), std::string::npos) << late_time;
    EXPECT_NE(late_time.find("late.xyz"), std::string::npos) << late_time;
    EXPECT_NE(refusal_of_start_at({.step = 3, .time = -1e17}, engine), "");
  }
}

TEST(SetUp, RefusesAViscosityAndFreeFlightsWhereCollisionsAreNotAllThatHappens) {
  Configuration plain = small();
  plain.box.edge = Edge::periodic;
  plain.engine.kind = "exact";
  plain.observe.viscosity_lag = 5;
  plain.observe.free_flights = true;
  EXPECT_NO_THROW(set_up(plain));
  auto const refusal = [&](auto change) -> std::string {
    Configuration configuration = plain;
    change(configuration);
    try {
      static_cast<void>(set_up(configuration));
    } catch (Error const& error) {
      return error.what();
    }
    return "";
  };
  auto const expect = [](std::string const& text, std::string const& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect(refusal([](Configuration& c) { c.engine.kind = "tiled"; }), "the engine \"tiled\" has no free flight");
  expect(refusal([](Configuration& c) {
           c.engine.thermostat = {.kind = ThermostatKind::andersen, .temperature = 1.0, .rate = 1.0};
         }),
         "a thermostat kicks the disks");
  expect(refusal([](Configuration& c) { c.engine.collisions.restitution = 0.9; }), "leave no equilibrium");
  expect(refusal([](Configuration& c) { c.box.edge = Edge::wall; }), "needs a box that is periodic in x and y");
  EXPECT_EQ(refusal([](Configuration& c) {
              c.observe.viscosity_lag = 0;
              c.engine.collisions.restitution = 0.9;
              c.box.edge = Edge::wall;
            }),
            "");
}

TEST(Simulate, SamplesTheStartEveryIntervalAndTheEnd) {
  RunResult const result = simulate(set_up(small()));
  std::vector<std::uint64_t> expected{0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 95};
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(result.series.column("step")), expected);
  EXPECT_EQ(result.status, RunStatus::finished);
  EXPECT_EQ(result.counters.moves, 64U * 95U);
}

TEST(Simulate, EndsAtWhicheverLengthComesFirst) {
  Configuration configuration = small();
  configuration.run.collisions_per_disk = 0.5;
  RunResult const by_collisions = simulate(set_up(configuration));
  EXPECT_LT(by_collisions.steps, 95U);
  EXPECT_GE(by_collisions.counters.pair_collisions, 16U);
  configuration = small();
  gridlock::Setup setup = set_up(configuration);
  configuration.run.time = 20.5 * setup.simulation->time_step();
  EXPECT_EQ(simulate(set_up(configuration)).steps, 21U);
}

/// Ten disks to and fro in rows of their own, one of them with some velocity across.
State rows_of_disks(double velocity_across) {
  State state{.box = Box(1.0, 1.0, Edge::wall), .agents = {}, .clock = {}, .seed = 1};
  for (int n = 0; n < 10; ++n) {
    state.agents.add(0.3 + 0.04 * n, 0.05 + 0.1 * n, n % 2 == 0 ? 1.0 : -0.7, n == 4 ? velocity_across : 0.0, 0.04, 1.0,
                     0, 0);
  }
  return state;
}

/// How many collisions there are once 50 were asked for and nothing else ends the run.
std::uint64_t collisions_waited_for(State state) {
  EngineSettings const settings{.kind = "exact", .time_step = 50.0};
  PatientEngine engine(make_engine(settings, state), patience_for(state));
  Counters counters;
  // A time to end with that is never reached, or the engine itself refuses to wait.
  engine.advance(state, counters, {.time = 1e12, .pair_collisions = 50});
  return counters.pair_collisions;
}

TEST(Simulate, GivesUpWaitingForCollisionsThatNeverCome) {
  try {
    collisions_waited_for(rows_of_disks(0.0));
    FAIL() << "collisions that cannot be";
  } catch (RunFailure const& failure) {
    EXPECT_NE(std::string(failure.what()).find("no two disks have met"), std::string::npos) << failure.what();
  }
  EXPECT_EQ(collisions_waited_for(rows_of_disks(0.01)), 50U);
}

TEST(Simulate, WaitsForCollisionsThatNeverComeUntilTheTimeThatEndsTheRunToo) {
  Configuration configuration;
  configuration.engine = {.kind = "exact", .time_step = 50.0};
  configuration.run.collisions_per_disk = 10.0;
  configuration.run.time = 9e4;  // its patience would end before
  configuration.observe = {.every = 1'000'000, .structure_every = 0};
  RunResult const result = simulate(set_up(configuration, {.start = rows_of_disks(0.0)}));
  EXPECT_EQ(result.status, RunStatus::finished) << result.failure;
  EXPECT_DOUBLE_EQ(result.clock.time, 9e4);
}

TEST(Simulate, TellsATiltThatIsChanged) {
  Configuration configuration;
  configuration.box = {.edge = Edge::periodic, .side = 1.0, .tilt = 0.8};
  configuration.disks.start = StartKind::uniform;
  configuration.protocol = {{.kind = "quench"}};
  auto const texts = [&] {
    std::vector<std::string> texts;
    for (Event const& note : set_up(configuration).notes) texts.push_back(to_text(note));
    return texts;
  };
  EXPECT_EQ(texts(),
            std::vector<std::string>{"box.tilt = 0.8 has the images of a box with the tilt -0.2, which is used"});
  configuration.box.tilt = 0.4;
  EXPECT_TRUE(texts().empty());
}

TEST(Simulate, AShearThatIsStoppedHasItsMinimaSoFar) {
  Configuration configuration;
  configuration.box.edge = Edge::periodic;
  configuration.disks = {.count = 32, .packing_fraction = 0.5, .start = StartKind::uniform};
  configuration.protocol = {{.kind = "quench", .packing_fraction = 0.9}, {.kind = "shear", .until_strain = 0.01}};
  gridlock::Setup setup = set_up(configuration);
  auto const stresses = [&] {
    for (Distribution const& table : setup.simulation->distributions()) {
      if (table.name == "shear") return table.columns_of_values[2];
    }
    return std::vector<double>();
  };
  int looks = 0;
  EXPECT_FALSE(setup.simulation->prepare([&] { return ++looks % 16 != 0 || stresses().size() < 4; }));
  std::vector<double> const part = stresses();
  EXPECT_TRUE(setup.simulation->prepare([] { return true; }));
  std::vector<double> const whole = stresses();
  ASSERT_EQ(whole.size(), 11U);
  ASSERT_LT(part.size(), whole.size());
  EXPECT_GE(part.size(), 4U);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin()));
}

TEST(Simulate, StoppedByTheCallerKeepsWhatThereIs) {
  RunResult const result = simulate(set_up(small()), [](Progress const&) { return false; });
  EXPECT_EQ(result.status, RunStatus::interrupted);
  EXPECT_LT(result.steps, 95U);
  EXPECT_EQ(result.world.clock.step, result.steps);
}

TEST(Simulate, ReportsProgressFromNothingToAll) {
  std::vector<double> fractions;
  simulate(set_up(small()), [&](Progress const& progress) {
    fractions.push_back(progress.fraction);
    return true;
  });
  ASSERT_FALSE(fractions.empty());
  EXPECT_TRUE(std::ranges::is_sorted(fractions));
  EXPECT_EQ(fractions.back(), 1.0);
}

TEST(SweepPlan, HasEveryCombinationWithTheLastListVaryingFastest) {
  SweepPlan const plan = plan_sweep(
      SettingsFile::from_text("[sweep]\ndisks.start = [\"square\", \"triangular\"]\nrun.seed = [1, 2, 3]\n", "s.toml"));
  EXPECT_EQ(plan.keys, (std::vector<std::string>{"disks.start", "run.seed"}));
  ASSERT_EQ(plan.runs.size(), 6U);
  EXPECT_EQ(plan.runs[0].name, "start=square_seed=1");
  EXPECT_EQ(plan.runs[1].name, "start=square_seed=2");
  EXPECT_EQ(plan.runs[5].name, "start=triangular_seed=3");
}

}  // namespace
