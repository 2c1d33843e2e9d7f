// Self-propelled disks: their headings, and what must not depend on how a run is computed.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "engine/headings.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "state_on_ranks.hpp"

namespace gridlock {
namespace {

PropulsionSettings const propulsion{.speed = 0.7, .rotational_diffusion = 15.0};

State start_of(std::size_t count, double packing_fraction, Edge edge = Edge::periodic) {
  return make_start(Box(1.3, 1.0, edge), {.count = count, .packing_fraction = packing_fraction}, 5);
}

State after(State state, EngineSettings const& settings, std::uint64_t steps, Counters* counters = nullptr) {
  Counters own;
  Counters& counts = counters == nullptr ? own : *counters;
  make_engine(settings, state)->advance(state, counts, {.step = state.clock.step + steps});
  return state;
}

double noise(std::uint64_t seed, std::uint64_t step, std::uint32_t disk) {
  return heading_noise(heading_step({.speed = 1.0, .width = 1.0, .seed = seed}, step), disk);
}

Vector turned(HeadingRule const& rule, std::uint64_t step, std::uint32_t disk, Vector velocity) {
  return turned_velocity(heading_step(rule, step), disk, velocity);
}

TEST(Headings, NoiseIsNormalToItsSixthMomentAndInItsTails) {
  constexpr std::uint32_t count = 1'000'000;
  double second = 0.0;
  double fourth = 0.0;
  double sixth = 0.0;
  double mean = 0.0;
  std::uint32_t beyond_3 = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    double const x = noise(3, 1 + k / 1000, k % 1000);
    double const square = x * x;
    mean += x / count;
    second += square / count;
    fourth += square * square / count;
    sixth += square * square * square / count;
    if (std::abs(x) > 3.0) ++beyond_3;
  }
  // Four standard errors of each mean; variances of x, x², x⁴, x⁶: 1, 2, 96, 10170.
  double const root = std::sqrt(count);
  EXPECT_NEAR(mean, 0.0, 4.0 / root);
  EXPECT_NEAR(second, 1.0, 4.0 * std::sqrt(2.0) / root);
  EXPECT_NEAR(fourth, 3.0, 4.0 * std::sqrt(96.0) / root);
  EXPECT_NEAR(sixth, 15.0, 4.0 * std::sqrt(10170.0) / root);
  double const expected = count * std::erfc(3.0 / std::numbers::sqrt2);
  EXPECT_NEAR(beyond_3, expected, 4.0 * std::sqrt(expected));
}

TEST(Headings, NoiseOfStepsDisksAndSeedsIsUncorrelated) {
  constexpr std::uint32_t count = 200'000;
  double step = 0.0;
  double disk = 0.0;
  double seed = 0.0;
  for (std::uint32_t k = 0; k < count; ++k) {
    double const x = noise(3, 7, k);
    step += x * noise(3, 8, k);
    disk += x * noise(3, 7, k + 1);
    seed += x * noise(4, 7, k);
  }
  double const limit = 4.0 * std::sqrt(count);
  EXPECT_LT(std::abs(step), limit);
  EXPECT_LT(std::abs(disk), limit);
  EXPECT_LT(std::abs(seed), limit);
}

TEST(Headings, TurnByTheAngleOfTheirNoiseToSixDigits) {
  HeadingRule const rule{.speed = 3.0, .width = 2.5, .seed = 9};
  for (std::uint32_t k = 0; k < 20'000; ++k) {
    double const before = 0.001 * k;
    Vector const after = turned(rule, k, k, 3.0 * direction(before));
    double const angle = before + 2.5 * noise(9, k, k);
    EXPECT_NEAR(after.x, 3.0 * std::cos(angle), 6e-6);
    EXPECT_NEAR(after.y, 3.0 * std::sin(angle), 6e-6);
  }
}

TEST(Headings, TurnInSinglePrecisionByAnyAngle) {
  for (double angle = -420.0; angle < 420.0; angle += 0.0137) {
    auto const single = static_cast<float>(angle);
    HeadingTurn const turn = heading_turn(single);
    double const error = 1e-7 * std::max(3.0, std::abs(angle));
    EXPECT_NEAR(turn.cosine, std::cos(static_cast<double>(single)), error);
    EXPECT_NEAR(turn.sine, std::sin(static_cast<double>(single)), error);
  }
}

TEST(Headings, KeepTheirLengthForAMillionSteps) {
  HeadingRule const rule{.speed = 0.3, .width = 0.7, .seed = 1};
  Vector velocity{0.3, 0.0};
  for (std::uint64_t step = 0; step < 1'000'000; ++step) velocity = turned(rule, step, 0, velocity);
  EXPECT_NEAR(std::sqrt(squared_length(velocity)), 0.3, 1e-13);
}

class RuleOfActiveDisks : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] EngineSettings settings() const {
    return {.kind = GetParam(), .speed = propulsion.speed, .threads = 1, .propulsion = propulsion};
  }
};
INSTANTIATE_TEST_SUITE_P(All, RuleOfActiveDisks, testing::Values("stepped", "tiled"));

TEST_P(RuleOfActiveDisks, NeverOverlapAndKeepTheirSpeed) {
  for (Edge const edge : {Edge::periodic, Edge::wall}) {
    State const end = after(start_of(500, 0.5, edge), settings(), 300);
    EXPECT_NO_THROW(validate(end));
    for (std::size_t i = 0; i < end.agents.size(); ++i) {
      EXPECT_NEAR(std::sqrt(squared_length(velocity(end.agents, i))), propulsion.speed, 1e-13);
    }
  }
}

TEST_P(RuleOfActiveDisks, TurnAsTheirNoiseSaysWhateverTheyMeet) {
  // The heading of a disk is a function of the seed, the step and the disk: crowds, walls, engines and registers do not
  // change it.
  State const start = start_of(500, 0.6, Edge::wall);
  for (double const rotational_diffusion : {0.0, 0.3, 200.0, 1e5}) {
    EngineSettings rule = settings();
    rule.propulsion.rotational_diffusion = rotational_diffusion;
    State const crowded = after(start, rule, 50);
    HeadingRule const heading = heading_rule(rule.propulsion, step_duration(rule, start), start.seed);
    for (std::uint32_t i = 0; i < start.agents.size(); ++i) {
      Vector v = propulsion.speed * first_heading(start.seed, i, velocity(start.agents, i));
      for (std::uint64_t step = 0; step < 50; ++step) v = turned(heading, step, i, v);
      EXPECT_EQ(velocity(crowded.agents, i), v);
    }
  }
}

TEST_P(RuleOfActiveDisks, HaveTheSameBitsHoweverTheRunIsCut) {
  State const whole = after(start_of(500, 0.5), settings(), 230);
  State cut = start_of(500, 0.5);
  for (std::uint64_t const steps : {1U, 99U, 30U, 100U}) cut = after(std::move(cut), settings(), steps);
  EXPECT_EQ(hash(cut), hash(whole));
}

TEST_P(RuleOfActiveDisks, SwimSlowerAmongOthers) {
  Counters alone;
  after(start_of(1, 0.01), settings(), 100, &alone);
  EXPECT_EQ(alone.swum, 500.0);
  EXPECT_EQ(alone.swum_if_free, 500.0);
  Counters crowd;
  after(start_of(500, 0.5), settings(), 300, &crowd);
  EXPECT_EQ(crowd.swum_if_free, 500.0 * 300.0 * 5.0);
  EXPECT_LT(crowd.swum, 0.8 * crowd.swum_if_free);
  EXPECT_GT(crowd.swum, 0.1 * crowd.swum_if_free);
  EXPECT_GT(crowd.pair_collisions, 0U);
  EXPECT_EQ(crowd.pair_virial, 0.0);
}

TEST_P(RuleOfActiveDisks, CountTheSubstepsThatTheyWereFree) {
  // The displacements along the headings, added up outside, are those counted.
  EngineSettings const rule = settings();
  State state = start_of(300, 0.5);
  auto const engine = make_engine(rule, state);
  Counters counters;
  double way = 0.0;
  for (int n = 0; n < 40; ++n) {
    State const before = state;
    engine->advance(state, counters, {.step = state.clock.step + 1});
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const moved = state.box.displacement_inside(position(before.agents, i), position(state.agents, i));
      way += dot(moved, velocity(state.agents, i)) / propulsion.speed;
    }
  }
  double const substep = propulsion.speed * engine->time_step() / 5.0;
  EXPECT_NEAR(way / substep, counters.swum, 1e-6 * counters.swum_if_free);
  EXPECT_LT(counters.swum, counters.swum_if_free);
}

TEST(ActiveDisks, HaveTheSameBitsAndCountersOnThreadsAndProcesses) {
  Counters of_one;
  EngineSettings settings{.kind = "tiled", .speed = propulsion.speed, .threads = 1, .propulsion = propulsion};
  State const one = after(start_of(6000, 0.5), settings, 130, &of_one);
  for (std::uint64_t const threads : {2U, 3U, 8U}) {
    settings.threads = threads;
    Counters counters;
    EXPECT_EQ(hash(after(start_of(6000, 0.5), settings, 130, &counters)), hash(one));
    EXPECT_EQ(counters.swum, of_one.swum);
  }
  settings.threads = 1;
  for (std::size_t const processes : {2U, 3U}) {
    State state = start_of(6000, 0.5);
    Counters counters;
    test::ThreadRanks ranks(processes);
    test::advance_on_ranks(settings, ranks, state, counters, {.step = 130});
    EXPECT_EQ(hash(state), hash(one));
    EXPECT_EQ(counters.swum, of_one.swum);
    EXPECT_EQ(counters.swum_if_free, of_one.swum_if_free);
  }
}

TEST(ActiveDisks, OfSteppedHaveTheSameBitsOnBothGrids) {
  EngineSettings settings{.kind = "stepped", .speed = propulsion.speed, .propulsion = propulsion};
  State const packed = after(start_of(500, 0.5), settings, 100);
  settings.grid = GridKind::linked;
  EXPECT_EQ(hash(after(start_of(500, 0.5), settings, 100)), hash(packed));
}

TEST(ActiveDisks, HaltAtWallsWithTheirHeadingsUnchanged) {
  State state{.box = Box(2.0, 1.0, Edge::wall)};
  state.agents.add(1.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);
  EngineSettings const settings{.kind = "stepped", .time_step = 0.1, .propulsion = {.speed = 1.0}};
  Counters counters;
  State const end = after(std::move(state), settings, 200, &counters);
  EXPECT_EQ(velocity(end.agents, 0), (Vector{1.0, 0.0}));
  EXPECT_GT(position(end.agents, 0).x, 1.9 - 0.0041);
  EXPECT_GT(counters.wall_hits[Counters::right], 100U);
  EXPECT_EQ(counters.wall_impulse[Counters::right], 0.0);
}

TEST(ActiveDisks, AreRefusedWhereSomeAreFixedAndInExactWithoutABath) {
  State state = start_of(3, 0.1);
  auto const key_of_refusal = [&](EngineSettings const& settings) -> std::string {
    try {
      make_engine(settings, state);
    } catch (Error const& error) {
      return error.problems().front().key;
    }
    return "";
  };
  PropulsionSettings const swims{.speed = 1.0};
  ThermostatSettings const andersen{.kind = ThermostatKind::andersen, .temperature = 1.0};
  ThermostatSettings const brownian{.kind = ThermostatKind::brownian, .temperature = 1.0};
  EXPECT_EQ(key_of_refusal({.kind = "exact", .propulsion = swims}), "propulsion.speed");
  EXPECT_EQ(key_of_refusal({.kind = "exact", .thermostat = andersen, .propulsion = swims}), "propulsion.speed");
  EXPECT_EQ(key_of_refusal({.kind = "exact", .thermostat = brownian, .propulsion = swims}), "");
  state.agents.column<Mass>()[1] = std::numeric_limits<double>::infinity();
  state.agents.column<VelocityX>()[1] = 0.0;
  state.agents.column<VelocityY>()[1] = 0.0;
  for (char const* const kind : {"stepped", "tiled"}) {
    EXPECT_EQ(key_of_refusal({.kind = kind}), "");
    EXPECT_EQ(key_of_refusal({.kind = kind, .propulsion = swims}), "propulsion.speed");
  }
}

TEST(ActiveDisks, AtRestGetRandomHeadings) {
  State state = start_of(400, 0.1);
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    state.agents.column<VelocityX>()[i] = 0.0;
    state.agents.column<VelocityY>()[i] = 0.0;
  }
  EngineSettings const settings{.kind = "tiled", .speed = 1.0, .propulsion = {.speed = 1.0}};
  State const end = after(std::move(state), settings, 1);
  Vector sum;
  for (std::size_t i = 0; i < end.agents.size(); ++i) sum = sum + velocity(end.agents, i);
  EXPECT_LT(std::sqrt(squared_length(sum)), 4.0 * std::sqrt(400.0 / 2.0));
  EXPECT_NEAR(std::sqrt(squared_length(velocity(end.agents, 0))), 1.0, 1e-13);
}

}  // namespace
}  // namespace gridlock
