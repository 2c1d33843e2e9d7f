// The engine `stepped` against exact results of small systems. The rule loses time at every halted move, so every
// average is off by a time-step error, linear in dt to leading order; three time steps h, h/2, h/4 remove the first two
// orders of it (Richardson), and what is left must be the exact value within its standard error.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "reference/mean_and_error.hpp"
#include "reference/paper_rule.hpp"
#include "reference/random_scene.hpp"

namespace gridlock {
namespace {

using reference::Estimate;
using reference::mean_of;

/// f(0) from f(h), f(h/2), f(h/4) for f = f(0) + a h + b h² + …
Estimate extrapolated(std::array<Estimate, 3> const& f) {
  auto const squared = [](double x) { return x * x; };
  return {(f[0].value - 6.0 * f[1].value + 8.0 * f[2].value) / 3.0,
          std::sqrt(squared(f[0].error) + squared(6.0 * f[1].error) + squared(8.0 * f[2].error)) / 3.0};
}

struct Blocks {
  int count = 20;
  double duration = 10.0;
  double relaxation = 0.0;
};

/// Runs a system and measures each block by the counters of that block alone and the time it took.
Estimate measure(State state, EngineSettings const& settings, Blocks const& blocks,
                 std::function<double(State const&, Counters const&, double)> const& quantity) {
  auto const engine = make_engine(settings, state);
  Counters relaxation;
  engine->advance(state, relaxation, {.time = blocks.relaxation});
  std::vector<double> values;
  for (int block = 0; block < blocks.count; ++block) {
    double const start = state.clock.time;
    Counters counters;
    engine->advance(state, counters, {.time = start + blocks.duration});
    values.push_back(quantity(state, counters, state.clock.time - start));
  }
  return mean_of(values);
}

constexpr std::array<double, 3> halving_time_steps{0.2, 0.1, 0.05};

double impulse_on_walls(Counters const& counters) {
  double sum = 0.0;
  for (double const impulse : counters.wall_impulse) sum += impulse;
  return sum;
}

std::string contact_name(testing::TestParamInfo<CollisionRule> const& info) {
  return info.param == CollisionRule::always ? "always" : "approaching";
}

class SteppedPhysics : public testing::TestWithParam<CollisionRule> {};
INSTANTIATE_TEST_SUITE_P(Contacts, SteppedPhysics, testing::Values(CollisionRule::always, CollisionRule::approaching),
                         contact_name);

// ---- the virial theorem ---------------------------------------------------------------------------------------------

TEST_P(SteppedPhysics, TheVirialChangesByFlightPairsAndWallsToTheLastDigits) {
  // G = Σ m r·v, r from the centre of the box, changes by m v² δt in every accepted sub-step, by −b·Δp_i in every
  // colliding pair and by r·Δp at every wall: an identity of the rule itself, for any time step.
  for (double const time_step : {0.4, 0.1}) {
    State state = reference::random_scene(
        {.width = 1.3, .count = 50, .packing_fraction = 0.5, .smallest_ratio = 0.5, .heaviest_mass = 3.0, .seed = 3});
    auto const engine = make_engine({.time_step = time_step, .contact = GetParam()}, state);
    reference::PaperRule rule(state, engine->time_step(), 5, GetParam() == CollisionRule::always);
    double const before = rule.virial();
    Counters counters;
    constexpr std::uint64_t steps = 1000;
    engine->advance(state, counters, {.step = steps});
    for (std::uint64_t step = 0; step < steps; ++step) rule.step();
    ASSERT_EQ(position(state.agents, 7), (Vector{rule.disks[7].x, rule.disks[7].y})) << "not the same trajectory";
    double const change = rule.flight_virial + counters.pair_virial + rule.wall_virial;
    EXPECT_NEAR(rule.virial() - before, change, 1e-12 * rule.flight_virial);
    EXPECT_GT(rule.flight_virial, 100.0) << "nothing happened";
  }
}

TEST_P(SteppedPhysics, TheWallVirialIdentityHoldsAsTheTimeStepVanishes) {
  // P_wall L (L − 2R) = K + ½ Σ σ m |v_n| / t for one trajectory of any number of equal disks in a hard box (physics
  // reference, section 2): the time average of dG/dt = 0, with walls acting at the distance R.
  for (double const packing_fraction : {0.3, 0.6}) {
    std::array<Estimate, 3> deviation;
    // The identity is that of a square of side 1.
    State const start = reference::random_scene(
        {.width = 1.0, .height = 1.0, .count = 50, .packing_fraction = packing_fraction, .seed = 3});
    double const r = start.agents.column<Radius>()[0];
    for (std::size_t n = 0; n < 3; ++n) {
      deviation[n] = measure(start, {.time_step = halving_time_steps[n], .contact = GetParam()},
                             {.count = 12, .duration = 20.0, .relaxation = 5.0},
                             [&](State const& state, Counters const& counters, double time) {
                               double const pressure = impulse_on_walls(counters) / (4.0 * time);
                               double const right = kinetic_energy(state.agents) + 0.5 * counters.pair_virial / time;
                               return pressure * (1.0 - 2.0 * r) / right - 1.0;
                             });
    }
    Estimate const limit = extrapolated(deviation);
    EXPECT_LT(std::abs(limit.value), 4.0 * limit.error) << "packing fraction " << packing_fraction;
    EXPECT_LT(limit.error, 0.005) << "too noisy to mean anything";
    // The time lost makes the walls see too little, by less and less: at least 35 % less for each halving.
    for (std::size_t n = 0; n < 3; ++n) EXPECT_LT(deviation[n].value, 0.0);
    for (std::size_t n = 0; n < 2; ++n) {
      EXPECT_LT(-deviation[n + 1].value, -0.65 * deviation[n].value + 4.0 * deviation[n + 1].error);
    }
  }
}

// ---- one row of disks -------------------------------------------------------------------------------------------------

constexpr double row_radius = 0.05;

State row_of(std::vector<double> const& velocities) {
  State state{.box = Box(1.0, 0.2, Edge::wall)};
  auto const count = static_cast<double>(velocities.size());
  for (std::size_t n = 0; n < velocities.size(); ++n) {
    state.agents.add((static_cast<double>(n) + 0.5) / count, 0.1, velocities[n], 0.0, row_radius, 1.0, 0, 0);
  }
  return state;
}

TEST_P(SteppedPhysics, OneMoverInARowComesBackWithThePeriodOfAFreeParticle) {
  // Equal disks in a row exchange velocities, so x_i − (i − ½)σ are free particles that pass through one another on
  // L' = L − Nσ; one mover repeats after 2L'/v. A period of the rule holds 2N events. Each shortens the way by less than a
  // sub-step δ and shifts the time by less than one step either way: the rest of a halted move is lost, but a disk hit
  // before its own turn moves a full step at once.
  constexpr double count = 6.0;
  double const path = 2.0 * (1.0 - count * 2.0 * row_radius);
  double const time = 100.0;
  for (double const time_step : {0.1, 0.03, 0.01, 0.003}) {
    State state = row_of({0.0, 1.0, 0.0, 0.0, 0.0, 0.0});
    auto const engine = make_engine({.time_step = time_step, .contact = GetParam()}, state);
    double const dt = engine->time_step();
    Counters counters;
    engine->advance(state, counters, {.time = time});
    double const longest = path + 2.0 * count * dt;
    double const shortest = path - 2.0 * count * (dt + dt / 5.0);
    for (Counters::Wall const wall : {Counters::left, Counters::right}) {
      auto const hits = static_cast<double>(counters.wall_hits[wall]);
      EXPECT_GE(hits, time / longest - 1.0) << "time step " << time_step;
      EXPECT_LE(hits, time / shortest + 1.0) << "time step " << time_step;
      EXPECT_NEAR(counters.wall_impulse[wall], 2.0 * hits, 1e-9) << "always the one speed";
    }
    EXPECT_EQ(counters.wall_hits[Counters::top], 0U);
  }
}

TEST_P(SteppedPhysics, ARowOfDisksPressesOnTheWallsLikeFreeParticles) {
  // Mean force on each end wall Σ v_i² / L' (physics reference, section 6).
  std::vector<double> const velocities{0.9, -0.35, 0.2, -0.75, 0.55};
  double squares = 0.0;
  for (double const v : velocities) squares += v * v;
  double const force = squares / (1.0 - static_cast<double>(velocities.size()) * 2.0 * row_radius);
  std::array<Estimate, 3> measured;
  for (std::size_t n = 0; n < 3; ++n) {
    measured[n] = measure(row_of(velocities), {.time_step = halving_time_steps[n], .contact = GetParam()},
                          {.count = 20, .duration = 100.0}, [](State const&, Counters const& counters, double time) {
                            return (counters.wall_impulse[Counters::left] + counters.wall_impulse[Counters::right]) /
                                   (2.0 * time);
                          });
    EXPECT_LT(measured[n].value, force) << "halted moves lose time";
  }
  Estimate const limit = extrapolated(measured);
  EXPECT_NEAR(limit.value, force, 4.0 * limit.error);
  EXPECT_LT(limit.error, 0.005 * force);
}

// ---- two disks in a box -------------------------------------------------------------------------------------------------

/// Two disks in a hard square box (physics reference, section 6), R ≤ L/4, with L = 1 and K/N = 1: the integral over
/// all allowed positions gives P = (K/N) [4a³ − 2πd²a + (8/3)d³] / (2LQ), Q = a⁴ − πd²a² + (8/3)ad³ − d⁴/2.
double pressure_of_two(double radius) {
  double const a = 1.0 - 2.0 * radius;
  double const d = 2.0 * radius;
  double const pi = std::numbers::pi;
  double const q = a * a * a * a - pi * d * d * a * a + 8.0 / 3.0 * a * d * d * d - 0.5 * d * d * d * d;
  return (4.0 * a * a * a - 2.0 * pi * d * d * a + 8.0 / 3.0 * d * d * d) / (2.0 * q);
}

State two_disks(double radius) {
  // Speeds √2 · (cos, sin): kinetic energy 1 each, and nothing symmetric.
  State state{.box = Box(1.0, 1.0, Edge::wall)};
  state.agents.add(0.3, 0.31, 1.2, 0.7483314773547883, radius, 1.0, 0, 0);
  state.agents.add(0.7, 0.72, -0.6, 1.2806248474865698, radius, 1.0, 0, 0);
  return state;
}

TEST(SteppedTwoDisks, TheFormulaGivesTheTabulatedPressures) {
  EXPECT_NEAR(pressure_of_two(0.05), 2.260746, 5e-7);
  EXPECT_NEAR(pressure_of_two(0.15), 3.543335, 5e-7);
  EXPECT_NEAR(pressure_of_two(0.20), 5.641119, 5e-7);
}

class SteppedTwoDisksAt : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Radii, SteppedTwoDisksAt, testing::Values(0.05, 0.15, 0.20));

TEST_P(SteppedTwoDisksAt, PressOnTheWallsAsTheConfigurationIntegralSays) {
  double const radius = GetParam();
  std::array<Estimate, 3> pressure;
  for (std::size_t n = 0; n < 3; ++n) {
    pressure[n] = measure(
        two_disks(radius), {.time_step = halving_time_steps[n]}, {.count = 25, .duration = 400.0},
        [](State const&, Counters const& counters, double time) { return impulse_on_walls(counters) / (4.0 * time); });
    EXPECT_LT(pressure[n].value, pressure_of_two(radius)) << "halted moves lose time";
  }
  Estimate const limit = extrapolated(pressure);
  EXPECT_NEAR(limit.value, pressure_of_two(radius), 4.0 * limit.error);
  EXPECT_LT(limit.error, 0.01 * pressure_of_two(radius));
}

TEST(SteppedTwoDisks, HitWallsAndEachOtherAsOftenAsTheyShould) {
  // At R = 0.15: 6.0154 wall hits and 1.9220 pair hits in unit time (physics reference, section 6).
  std::array<Estimate, 3> walls;
  std::array<Estimate, 3> pairs;
  for (std::size_t n = 0; n < 3; ++n) {
    EngineSettings const settings{.time_step = halving_time_steps[n], .contact = CollisionRule::approaching};
    Blocks const blocks{.count = 25, .duration = 1000.0};
    walls[n] = measure(two_disks(0.15), settings, blocks, [](State const&, Counters const& counters, double time) {
      return static_cast<double>(counters.all_wall_hits()) / time;
    });
    pairs[n] = measure(two_disks(0.15), settings, blocks, [](State const&, Counters const& counters, double time) {
      return static_cast<double>(counters.pair_collisions) / time;
    });
  }
  EXPECT_NEAR(extrapolated(walls).value, 6.0154, 4.0 * extrapolated(walls).error);
  EXPECT_NEAR(extrapolated(pairs).value, 1.9220, 4.0 * extrapolated(pairs).error);
  EXPECT_LT(extrapolated(walls).error, 0.06);
  EXPECT_LT(extrapolated(pairs).error, 0.05);
}

}  // namespace
}  // namespace gridlock
