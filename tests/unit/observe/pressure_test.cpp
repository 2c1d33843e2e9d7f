#include "observe/pressure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

State two_disks(Box const& box) {
  State state = empty_state(box);
  add_disk(state, {0.25 * box.width(), 0.5}, {1, 0}, 0.1);
  add_disk(state, {0.75 * box.width(), 0.5}, {-1, 2}, 0.1);
  return state;
}

TEST(Pressure, OfDisksThatMeetNobodyIsThatOfTheIdealGas) {
  // K = ½(1 + 5) = 3 between walls; P = (0, 2), K − P²/2M = 2 for the one relative motion in a periodic box.
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State state = two_disks(Box(3, 2, edge));
    Pressure pressure;
    pressure.begin({state, {}});
    state.clock.time = 4.0;
    auto const row = sample(pressure, state);
    double const kt = edge == Edge::wall ? 1.5 : 2.0;
    EXPECT_DOUBLE_EQ(cell(pressure, row, "virial_pressure"), 2 * kt / 6.0);
    EXPECT_DOUBLE_EQ(cell(pressure, row, "compressibility_factor"), 1.0);
  }
}

TEST(Pressure, OfPairsComesFromTheirVirial) {
  State state = two_disks(Box(3, 2, Edge::wall));  // N kT = 3, A = 6
  Counters counters{.pair_virial = 100.0};
  Pressure pressure;
  pressure.begin({state, counters});
  state.clock.time = 4.0;
  counters.pair_virial += 24.0;
  auto const row = sample(pressure, state, counters);
  EXPECT_DOUBLE_EQ(cell(pressure, row, "virial_pressure"), (3.0 + 24.0 / 8.0) / 6.0);
  EXPECT_DOUBLE_EQ(cell(pressure, row, "compressibility_factor"), 2.0);
}

TEST(Pressure, AveragesOfTheCompressibilityAreRatiosOfSumsThoughTheTemperatureChanges) {
  // 24 of virial while N kT = 3 for a time of 4, 48 while N kT = 12 for a time of 1: Z = 1 + ΣW / (2 Σ N kT t).
  State state = two_disks(Box(3, 2, Edge::wall));
  Counters counters;
  Pressure pressure;
  pressure.begin({state, counters});
  state.clock.time = 4.0;
  counters.pair_virial = 24.0;
  sample(pressure, state, counters);
  for (double& v : state.agents.column<VelocityX>()) v *= 2.0;
  for (double& v : state.agents.column<VelocityY>()) v *= 2.0;
  state.clock.time = 5.0;
  counters.pair_virial += 48.0;
  sample(pressure, state, counters);
  EXPECT_DOUBLE_EQ(result(pressure, "compressibility_factor")->value, 1.0 + 72.0 / (2.0 * (3.0 * 4.0 + 12.0 * 1.0)));
  EXPECT_DOUBLE_EQ(result(pressure, "virial_pressure")->value, ((3.0 * 4.0 + 12.0 * 1.0) + 36.0) / (5.0 * 6.0));
}

TEST(Pressure, OfWallsIsImpulsePerTimeAndLength) {
  State state = two_disks(Box(3, 2, Edge::wall));
  Counters counters;
  counters.wall_impulse = {9, 9, 9, 9};
  Pressure pressure;
  pressure.begin({state, counters});
  state.clock.time = 4.0;
  counters.wall_impulse = {9 + 8, 9 + 16, 9 + 24, 9 + 48};
  auto const row = sample(pressure, state, counters);
  EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure_left"), 8 / (4.0 * 2));
  EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure_right"), 16 / (4.0 * 2));
  EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure_bottom"), 24 / (4.0 * 3));
  EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure_top"), 48 / (4.0 * 3));
  EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure"), 96 / (4.0 * 10));
}

TEST(Pressure, InAChannelIsThatOfTheWallsThatThereAre) {
  struct Case {
    Box box;
    std::size_t wall;
    char const* name;
    double length;
    char const* absent;
  };
  for (Case const& c :
       {Case{Box(3, 2, Edge::periodic, Edge::wall), Counters::top, "wall_pressure_top", 3.0, "left"},
        Case{Box(3, 2, Edge::wall, Edge::periodic), Counters::right, "wall_pressure_right", 2.0, "top"}}) {
    State state = two_disks(c.box);
    Pressure pressure;
    pressure.begin({state, {}});
    for (ColumnInfo const& column : pressure.columns()) {
      EXPECT_NE(column.name, std::string("wall_pressure_") + c.absent);
    }
    state.clock.time = 4.0;
    Counters counters;
    counters.wall_impulse[c.wall] = 24.0;
    auto const row = sample(pressure, state, counters);
    EXPECT_DOUBLE_EQ(cell(pressure, row, c.name), 24.0 / (4.0 * c.length));
    EXPECT_DOUBLE_EQ(cell(pressure, row, "wall_pressure"), 24.0 / (4.0 * 2.0 * c.length));
  }
}

TEST(Pressure, OneDiskBetweenWallsObeysTheVirialTheorem) {
  // A disk with |v_x| = 2 hits left and right once each in the period 2(L − 2R)/|v_x|, with impulse 2 m |v_x|; in y the
  // same with |v_y| = 1. Over whole periods of both: P L (L − 2R) = K.
  constexpr double side = 1.0;
  constexpr double radius = 0.1;
  constexpr double mass = 3.0;
  State state = empty_state(Box(side, side, Edge::wall));
  add_disk(state, {0.3, 0.4}, {2, -1}, radius, mass);
  Pressure pressure;
  pressure.begin({state, {}});
  state.clock.time = 2.0 * (side - 2.0 * radius) / 1.0;
  Counters const counters{.wall_hits = {2, 2, 1, 1},
                          .wall_impulse = {2 * 2 * mass * 2, 2 * 2 * mass * 2, 2 * mass, 2 * mass}};
  auto const row = sample(pressure, state, counters);
  EXPECT_NEAR(cell(pressure, row, "wall_pressure") * side * (side - 2 * radius), 0.5 * mass * 5.0, 1e-12);
}

TEST(Pressure, AHeadOnPairBetweenWallsTiesWallsToPairs) {
  // Two equal disks on one line meet in the middle and rebound from opposite walls: each runs (L − 4R)/2 to the wall
  // and back per period t = (L − 4R)/v. In it one pair collision with |v_n| = 2v, W = 2R m 2v, and one hit of 2mv on
  // the left and on the right wall. The virial theorem in x: (F_x) (L − 2R) = 2K + W/t with F_x = 2mv/t.
  constexpr double v = 1.5;
  constexpr double side = 2.0;
  constexpr double radius = 0.2;
  State state = empty_state(Box(side, side, Edge::wall));
  add_disk(state, {0.5, 1}, {v, 0}, radius);
  add_disk(state, {1.5, 1}, {-v, 0}, radius);
  Pressure pressure;
  pressure.begin({state, {}});
  double const period = (side - 4 * radius) / v;
  state.clock.time = period;
  Counters const counters{.pair_collisions = 1,
                          .wall_hits = {1, 1, 0, 0},
                          .wall_impulse = {2 * v, 2 * v, 0, 0},
                          .pair_virial = 2 * radius * 2 * v};
  auto const row = sample(pressure, state, counters);
  double const kinetic = v * v;
  // wall_pressure · L (L − 2R) = K + W/2t, the identity of the physics reference.
  double const walls = cell(pressure, row, "wall_pressure") * side * (side - 2 * radius);
  EXPECT_NEAR(walls, kinetic + 0.5 * counters.pair_virial / period, 1e-12);
  EXPECT_NEAR(walls, cell(pressure, row, "virial_pressure") * side * side, 1e-12);
}

TEST(Pressure, AveragesAreRatiosOfSumsOverWhatCounts) {
  State state = two_disks(Box(3, 2, Edge::wall));
  Counters counters;
  Pressure pressure;
  pressure.begin({state, counters});
  auto const pass = [&](double time, double virial, double impulse, bool counts) {
    state.clock.time += time;
    counters.pair_virial += virial;
    counters.wall_impulse[Counters::left] += impulse;
    sample(pressure, state, counters, counts);
  };
  pass(1.0, 1000, 1000, false);
  pass(1.0, 6, 2, true);
  pass(3.0, 0, 10, true);
  EXPECT_DOUBLE_EQ(result(pressure, "compressibility_factor")->value, 1.0 + 6.0 / (2 * 3.0 * 4.0));
  EXPECT_DOUBLE_EQ(result(pressure, "wall_pressure_left")->value, 12 / (4.0 * 2));
  EXPECT_DOUBLE_EQ(result(pressure, "wall_pressure")->value, 12 / (4.0 * 10));
}

TEST(Pressure, AtRestHasNoCompressibilityFactor) {
  State state = empty_state(Box(1, 1, Edge::wall));
  add_disk(state, {0.5, 0.5});
  Pressure pressure;
  pressure.begin({state, {}});
  state.clock.time = 1.0;
  auto const row = sample(pressure, state);
  EXPECT_EQ(cell(pressure, row, "virial_pressure"), 0.0);
  EXPECT_TRUE(std::isnan(cell(pressure, row, "compressibility_factor")));
  EXPECT_FALSE(result(pressure, "compressibility_factor"));
}

}  // namespace
}  // namespace gridlock
