#include "core/temperature.hpp"

#include <gtest/gtest.h>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

State pair_of_disks(Edge edge, Vector first, Vector second) {
  State state = empty_state(Box(1, 1, edge));
  add_disk(state, {0.25, 0.5}, first, 0.1, 1.0);
  add_disk(state, {0.75, 0.5}, second, 0.1, 3.0);
  return state;
}

TEST(Temperature, BetweenWallsIsTheKineticEnergyPerDisk) {
  // K = ½·1·4 + ½·3·1 = 3.5 for two disks.
  EXPECT_DOUBLE_EQ(*temperature(pair_of_disks(Edge::wall, {2, 0}, {0, 1})), 1.75);
}

TEST(Temperature, InAPeriodicBoxLeavesOutTheMotionOfTheCentreOfMass) {
  // P = (2, 3), M = 4, P²/2M = 13/8; two disks have one relative motion.
  EXPECT_DOUBLE_EQ(*temperature(pair_of_disks(Edge::periodic, {2, 0}, {0, 1})), 3.5 - 13.0 / 8.0);
}

TEST(Temperature, InAPeriodicBoxDoesNotFeelACommonDrift) {
  Vector const drift{10, -20};
  double const still = *temperature(pair_of_disks(Edge::periodic, {2, 0}, {0, 1}));
  double const drifting = *temperature(pair_of_disks(Edge::periodic, Vector{2, 0} + drift, Vector{0, 1} + drift));
  EXPECT_NEAR(drifting, still, 1e-12);
  double const common = *temperature(pair_of_disks(Edge::periodic, drift, drift));
  EXPECT_GE(common, 0.0);
  EXPECT_NEAR(common, 0.0, 1e-12);
}

TEST(Temperature, InAChannelLeavesOutTheMotionOfTheCentreAlongIt) {
  // P = (2, 3), M = 4: along x 4/8 is not thermal, and three of four degrees of freedom are left.
  State state = pair_of_disks(Edge::periodic, {2, 0}, {0, 1});
  state.box = Box(1, 1, Edge::periodic, Edge::wall);
  EXPECT_DOUBLE_EQ(*temperature(state), (3.5 - 0.5) / 1.5);
  state.box = Box(1, 1, Edge::wall, Edge::periodic);
  EXPECT_DOUBLE_EQ(*temperature(state), (3.5 - 9.0 / 8.0) / 1.5);
  State one = empty_state(Box(1, 1, Edge::periodic, Edge::wall));
  add_disk(one, {0.5, 0.5}, {3, 2});
  EXPECT_DOUBLE_EQ(*temperature(one), 4.0) << "m vy² is kT, and vx is that of the centre";
}

TEST(Temperature, IsAbsentWhereNothingMovesFreely) {
  EXPECT_FALSE(temperature(empty_state(Box(1, 1, Edge::wall))));
  EXPECT_FALSE(temperature(empty_state(Box(1, 1, Edge::periodic))));
  State one = empty_state(Box(1, 1, Edge::periodic));
  add_disk(one, {0.5, 0.5}, {1, 0});
  EXPECT_FALSE(temperature(one));
  one.box = Box(1, 1, Edge::wall);
  EXPECT_DOUBLE_EQ(*temperature(one), 0.5);
}

}  // namespace
}  // namespace gridlock
