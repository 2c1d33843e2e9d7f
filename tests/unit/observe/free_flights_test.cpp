#include "observe/free_flights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using hand_built::sample;

PairCollision collision_at(double time, double speed_i, double speed_j) {
  return {.time = time,
          .i = 0,
          .j = 1,
          .separation = {1.0, 0.0},
          .velocity_i = {0.6 * speed_i, 0.8 * speed_i},
          .velocity_j = {speed_j, 0.0},
          .mass_i = 1.0,
          .mass_j = 1.0,
          .impulse = {}};
}

TEST(FreeFlights, CountEachFlightFromTheSecondCollisionOfADiskOnInBinsOfEighthsOfPowersOfTwo) {
  State const state = hand_built::ideal_gas(Box(3.0, 2.0, Edge::periodic), 3, 0.1, 1);
  FreeFlights flights;
  flights.begin({state, {}});
  flights.collided(collision_at(1.0, 5.0, 5.0));
  EXPECT_TRUE(std::isnan(sample(flights, state)[0]));
  flights.collided(collision_at(3.0, 1.0, 0.5));  // two flights of time 2, of paths 2 and 1
  flights.collided(collision_at(3.3, 1.0, 0.0));  // two of time 0.3, of paths 0.3 and 0
  EXPECT_DOUBLE_EQ(sample(flights, state)[0], 3.3 / 4.0);
  auto const tables = flights.distributions();
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name, "free_time_distribution");
  EXPECT_EQ(tables[1].name, "free_path_distribution");
  auto const& times = tables[0].columns_of_values;
  // 0.3 lies in the bin from 0.28125 to 0.3125, and 2 in that from 2 to 2.25.
  EXPECT_DOUBLE_EQ(times[0].front(), 0.296875);
  EXPECT_DOUBLE_EQ(times[1].front(), 0.5 / 0.03125);
  EXPECT_DOUBLE_EQ(times[2].front(), std::sqrt(2.0) / 4.0 / 0.03125);
  EXPECT_DOUBLE_EQ(times[0].back(), 2.125);
  EXPECT_DOUBLE_EQ(times[1].back(), 0.5 / 0.25);
  double all = 0.0;
  for (double const count : times[3]) all += count;
  EXPECT_EQ(all, 4.0);
}

TEST(FreeFlights, LeaveOutFlightsThatEndedBeforeTheSamplesThatCount) {
  State const state = hand_built::ideal_gas(Box(3.0, 2.0, Edge::periodic), 2, 0.1, 1);
  FreeFlights flights;
  flights.begin({state, {}});
  flights.collided(collision_at(1.0, 1.0, 1.0));
  flights.collided(collision_at(2.0, 7.0, 7.0));
  EXPECT_DOUBLE_EQ(sample(flights, state, {}, false)[0], 7.0);
  flights.collided(collision_at(5.0, 1.0, 2.0));
  EXPECT_DOUBLE_EQ(sample(flights, state)[0], 4.5);
  EXPECT_DOUBLE_EQ(hand_built::result(flights, "mean_free_path")->value, 4.5);
  EXPECT_EQ(flights.distributions()[0].columns_of_values[3], std::vector{2.0});
}

TEST(FreeFlights, RefuseFixedDisks) {
  State state = hand_built::ideal_gas(Box(3.0, 2.0, Edge::periodic), 2, 0.1, 1);
  state.agents.column<Mass>()[0] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(FreeFlights().begin({state, {}}), Error);
}

}  // namespace
}  // namespace gridlock
