#include "observe/velocity_autocorrelation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

State maxwell_gas(std::size_t count, std::uint64_t seed) {
  State state = ideal_gas(Box(1, 1, Edge::wall), count, 0.01, seed);
  draw_maxwell(state, 1.0, seed);
  return state;
}

State turned(State const& state, Vector along, Vector across) {
  State result = state;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    Vector const v = velocity(state.agents, i);
    result.agents.column<VelocityX>()[i] = dot(along, v);
    result.agents.column<VelocityY>()[i] = dot(across, v);
  }
  return result;
}

TEST(VelocityAutocorrelation, IsOneWhereNothingTurnedMinusOneReversedAndTheCosineOfATurn) {
  State const state = maxwell_gas(50, 1);
  VelocityAutocorrelation correlation;
  correlation.begin({state, {}});
  EXPECT_DOUBLE_EQ(sample(correlation, state)[0], 1.0);
  EXPECT_DOUBLE_EQ(sample(correlation, turned(state, {-1, 0}, {0, -1}))[0], -1.0);
  EXPECT_NEAR(sample(correlation, turned(state, {0, -1}, {1, 0}))[0], 0.0, 1e-15);
  EXPECT_NEAR(sample(correlation, turned(state, {0.6, -0.8}, {0.8, 0.6}))[0], 0.6, 1e-14);
  auto const distributions = correlation.distributions();
  ASSERT_EQ(distributions.size(), 1U);
  EXPECT_EQ(distributions[0].columns_of_values[1].size(), 4U);
  EXPECT_NEAR(distributions[0].columns_of_values[2][3], 0.0, 1e-14) << "every disk agrees";
}

TEST(VelocityAutocorrelation, IsInUnitsOfTheSquaredVelocitiesAtTheOrigin) {
  State state = empty_state(Box(1, 1, Edge::wall));
  add_disk(state, {0.2, 0.5}, {1, 0});
  add_disk(state, {0.8, 0.5}, {0, 2});
  VelocityAutocorrelation correlation;
  correlation.begin({state, {}});
  sample(correlation, state);
  state.agents.column<VelocityX>()[0] = 3.0;  // (1·3 + 2·2) / (1 + 4)
  EXPECT_DOUBLE_EQ(sample(correlation, state)[0], 7.0 / 5.0);
}

TEST(VelocityAutocorrelation, StartsAtTheFirstSampleThatCounts) {
  State early = maxwell_gas(50, 1);
  State late = maxwell_gas(50, 2);
  late.clock.time = 3.0;
  VelocityAutocorrelation correlation;
  correlation.begin({early, {}});
  EXPECT_TRUE(std::isnan(sample(correlation, early, {}, false)[0]));
  EXPECT_DOUBLE_EQ(sample(correlation, late)[0], 1.0);
  late.clock.time = 5.5;
  sample(correlation, late, {}, false);
  EXPECT_EQ(correlation.distributions()[0].columns_of_values[0], (std::vector<double>{0.0, 2.5}));
}

TEST(VelocityAutocorrelation, AveragesOverOriginsAndTellsTheErrorFromTheirScatter) {
  // Every origin is a state of its own, and in the sample after it all velocities are turned by the angle of that
  // origin.
  VelocityAutocorrelation correlation(2);
  double const cosines[] = {0.0, 0.6, 0.8, 1.0};
  State const state = maxwell_gas(50, 1);
  correlation.begin({state, {}});
  State now = state;
  for (double const c : cosines) {
    double const s = std::sqrt(1.0 - c * c);
    EXPECT_DOUBLE_EQ(sample(correlation, now)[0], 1.0);
    now.clock.time += 0.5;
    State later = turned(now, {c, -s}, {s, c});
    later.clock.time = now.clock.time;
    EXPECT_NEAR(sample(correlation, later)[0], c, 1e-14);
    now.clock.time += 0.5;
  }
  auto const columns = correlation.distributions()[0].columns_of_values;
  EXPECT_EQ(columns[0], (std::vector<double>{0.0, 0.5}));
  EXPECT_NEAR(columns[1][1], 0.6, 1e-14);
  // √(Σ (c − 0.6)² / (4·3)) of the four.
  EXPECT_NEAR(columns[2][1], std::sqrt((0.36 + 0.0 + 0.04 + 0.16) / 12.0), 1e-14);
}

TEST(VelocityAutocorrelation, AnEarlyLastSampleIsInTheSeriesButInNoPointOfTheCurve) {
  VelocityAutocorrelation correlation(2);
  State now = maxwell_gas(50, 1);
  correlation.begin({now, {}});
  for (double const time : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    now.clock.time = time;
    EXPECT_DOUBLE_EQ(sample(correlation, now)[0], 1.0) << time;
  }
  // The run ends 0.2 after the third origin, where the curve has its points at 0 and 0.5.
  State last = turned(now, {-1, 0}, {0, -1});
  last.clock.time = 2.2;
  EXPECT_DOUBLE_EQ(sample(correlation, last)[0], -1.0);
  auto const columns = correlation.distributions()[0].columns_of_values;
  EXPECT_EQ(columns[0], (std::vector<double>{0.0, 0.5}));
  EXPECT_NEAR(columns[1][0], 1.0, 1e-14);
  EXPECT_NEAR(columns[1][1], 1.0, 1e-14);
}

TEST(VelocityAutocorrelation, OfIndependentVelocitiesIsZeroWithinItsError) {
  // The pull of 16 blocks is Student's t with 15 degrees of freedom, variance 15/13.
  double squares = 0.0;
  constexpr int replicas = 400;
  for (std::uint64_t replica = 0; replica < replicas; ++replica) {
    VelocityAutocorrelation correlation;
    State const origin = maxwell_gas(400, 2 * replica);
    correlation.begin({origin, {}});
    sample(correlation, origin);
    double const value = sample(correlation, maxwell_gas(400, 2 * replica + 1))[0];
    squares += std::pow(value / correlation.distributions()[0].columns_of_values[2][1], 2) / replicas;
  }
  EXPECT_NEAR(squares, 15.0 / 13.0, 4.0 * 15.0 / 13.0 * std::sqrt(2.6 / replicas));
}

TEST(VelocityAutocorrelation, FollowsIdsWhenRowsAreReordered) {
  State const state = maxwell_gas(50, 1);
  VelocityAutocorrelation correlation;
  correlation.begin({state, {}});
  sample(correlation, state);
  EXPECT_DOUBLE_EQ(sample(correlation, with_rows_reversed(state))[0], 1.0);
}

TEST(VelocityAutocorrelation, IsUndefinedAtRest) {
  State const state = ideal_gas(Box(1, 1, Edge::wall), 5, 0.01, 1);
  VelocityAutocorrelation correlation;
  correlation.begin({state, {}});
  EXPECT_TRUE(std::isnan(sample(correlation, state)[0]));
  EXPECT_TRUE(correlation.distributions().empty());
}

}  // namespace
}  // namespace gridlock
