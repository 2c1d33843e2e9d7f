// Walls against pairs: the identity that ties the two pressures of one trajectory together.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using hand_built::result;
using hand_built::sample;

/// Σ m (r − c)·v about the centre c of the box.
double virial_of_motion(State const& state) {
  Vector const centre{0.5 * state.box.width(), 0.5 * state.box.height()};
  double sum = 0.0;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    sum += state.agents.column<Mass>()[i] * dot(position(state.agents, i) - centre, velocity(state.agents, i));
  }
  return sum;
}

/// By how much, relative to K + W/2t, the walls feel less than the virial theorem says for exact dynamics:
///
///     Δ(Σ m r·v) = 2K t + W − wall impulses · (L/2 − R)
///
/// with K + W/2t and the wall term from the observables and the change of Σ m r·v taken into account, so that no
/// statistical error is left at all.
double shortfall_of_walls(double time_step, CollisionRule contact, std::uint64_t steps) {
  State state = make_start(Box(1, 1, Edge::wall), {.count = 100, .packing_fraction = 0.4}, 3);
  draw_velocities(state, {});
  auto const engine = make_engine({.time_step = time_step, .contact = contact}, state);
  Counters counters;
  auto const observables = make_observables({.structure_every = 0}, {state, counters});
  double const at_start = virial_of_motion(state);
  for (std::uint64_t chunk = 1; chunk <= 8; ++chunk) {
    engine->advance(state, counters, {.step = chunk * steps / 8});
    for (auto const& observable : observables) sample(*observable, state, counters);
  }
  double const boundary = (virial_of_motion(state) - at_start) / (2.0 * state.clock.time);
  double walls = 0.0;
  double pairs = 0.0;
  for (auto const& observable : observables) {
    if (auto const estimate = result(*observable, "wall_pressure")) walls = estimate->value;
    if (auto const estimate = result(*observable, "virial_pressure")) pairs = estimate->value * state.box.area();
  }
  double const radius = state.agents.column<Radius>()[0];
  // wall_pressure · L (L − 2R) = K + W/2t − Δ(Σ m r·v)/2t
  return 1.0 - walls * (1.0 - 2.0 * radius) / (pairs - boundary);
}

class WallVirialIdentity : public testing::TestWithParam<CollisionRule> {};

TEST_P(WallVirialIdentity, HoldsForOneTrajectoryUpToAnErrorProportionalToTheTimeStep) {
  // The stepped rule halts a disk for the rest of a step at every encounter, so that a share of 2K t, proportional to
  // the time step, is missing from the motion; the identity itself is exact. Same physical time for every step.
  double const coarse = shortfall_of_walls(0.1, GetParam(), 1600);
  double const middle = shortfall_of_walls(0.05, GetParam(), 3200);
  double const fine = shortfall_of_walls(0.0125, GetParam(), 12'800);
  EXPECT_GT(coarse, 0.0);
  EXPECT_LT(coarse, 0.04);
  EXPECT_NEAR(middle / coarse, 0.5, 0.1);
  EXPECT_NEAR(fine / coarse, 0.125, 0.03);
  EXPECT_LT(std::abs(fine), 0.005);
}

INSTANTIATE_TEST_SUITE_P(Contacts, WallVirialIdentity,
                         testing::Values(CollisionRule::always, CollisionRule::approaching), [](auto const& contact) {
                           return contact.param == CollisionRule::always ? "always" : "approaching";
                         });

TEST(OneDiskBetweenWalls, ObeysTheVirialTheoremUpToTheTimeStep) {
  // A single disk: nothing but walls, P L (L − 2R) = K − Δ(m r·v)/2t. A halt at a wall costs between none and one step
  // plus the way to the wall, less than a sub-step each way: at most 1.4 steps of a crossing of (L − 2R)/v.
  constexpr double time_step = 0.001;
  Vector const v{0.61, 0.37};
  State state = hand_built::empty_state(Box(1, 1, Edge::wall));
  hand_built::add_disk(state, {0.5, 0.5}, v, 0.1);
  auto const engine = make_engine({.time_step = time_step / 0.2, .speed = 1.0}, state);
  Counters counters;
  auto const observables = make_observables({.structure_every = 0}, {state, counters});
  double const at_start = virial_of_motion(state);
  engine->advance(state, counters, {.step = 200'000});
  double const boundary = (virial_of_motion(state) - at_start) / (2.0 * state.clock.time);
  bool is_measured = false;
  for (auto const& observable : observables) {
    sample(*observable, state, counters);
    auto const walls = result(*observable, "wall_pressure");
    if (!walls) continue;
    is_measured = true;
    double const shortfall = 1.0 - walls->value * 0.8 / (kinetic_energy(state.agents) - boundary);
    EXPECT_GE(shortfall, 0.0);
    EXPECT_LT(shortfall, 1.4 * time_step * v.x / 0.8);
  }
  EXPECT_TRUE(is_measured);
}

}  // namespace
}  // namespace gridlock
