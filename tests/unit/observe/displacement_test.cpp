#include "observe/displacement.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "gridlock/engine/engine.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

TEST(Displacement, IsZeroAtTheStart) {
  State const state = ideal_gas(Box(1, 1, Edge::wall), 40, 0.01, 1);
  Displacement displacement;
  displacement.begin({state, {}});
  auto const row = sample(displacement, state);
  EXPECT_EQ(row[0], 0.0);
  EXPECT_EQ(row[1], 0.0);
}

TEST(Displacement, IsMeasuredInSidesAndItsSquareInLengths) {
  State state = empty_state(Box(4, 9, Edge::wall));  // √area = 6
  add_disk(state, {1, 1});
  Displacement displacement;
  displacement.begin({state, {}});
  state.agents.column<X>()[0] += 1.5;
  state.agents.column<Y>()[0] += 2.0;
  auto const row = sample(displacement, state);
  EXPECT_DOUBLE_EQ(row[0], 2.5 / 6.0);
  EXPECT_DOUBLE_EQ(row[1], 6.25);
}

TEST(Displacement, OfTheCentreIsThatOfTheMeanPlace) {
  State state = empty_state(Box(4, 9, Edge::periodic));  // √area = 6
  add_disk(state, {1, 1}, {}, 0.01, 5.0);                // masses do not count
  add_disk(state, {2, 2});
  Displacement displacement;
  displacement.begin({state, {}});
  state.agents.column<X>()[0] += 1.0;
  state.agents.column<ImageX>()[1] = 1;  // once around, to its place
  state.agents.column<Y>()[1] += 3.0;
  auto const row = sample(displacement, state);
  EXPECT_DOUBLE_EQ(row[2], std::hypot(2.5, 1.5) / 6.0);
  ASSERT_TRUE(result(displacement, "centre_displacement"));
  EXPECT_DOUBLE_EQ(result(displacement, "centre_displacement")->value, row[2]);
  EXPECT_FALSE(result(displacement, "centre_displacement")->error);
  // About the centre: ⟨u²⟩ − |⟨u⟩|² is the scatter, ±(1.5, 1.5) here.
  EXPECT_NEAR(row[1] - 36.0 * row[2] * row[2], 4.5, 1e-12);
}

TEST(Displacement, OfTheCentreIsNothingWhereDisksMoveApart) {
  State state = empty_state(Box(1, 1, Edge::periodic));
  add_disk(state, {0.5, 0.5});
  add_disk(state, {0.5, 0.5});
  Displacement displacement;
  displacement.begin({state, {}});
  state.agents.column<X>()[0] += 0.25;
  state.agents.column<X>()[1] -= 0.25;
  auto const row = sample(displacement, state);
  EXPECT_EQ(row[2], 0.0);
  EXPECT_EQ(row[0], 0.25);
}

TEST(Displacement, FollowsADiskThroughPeriodicEdges) {
  // Free flight of 40 steps with the engine itself: one and a half times around in x, once back in y.
  State state = empty_state(Box(1, 1, Edge::periodic));
  add_disk(state, {0.9, 0.2}, {1.5, -1.0}, 0.05);
  EngineSettings const settings{.time_step = 0.25};  // 0.025 time units
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.step = 4});
  Displacement displacement;
  displacement.begin({state, counters});  // images that are not zero at the start must not count
  std::uint64_t const first = state.clock.step;
  double const start = state.clock.time;
  engine->advance(state, counters, {.step = first + 40});
  auto const row = sample(displacement, state, counters);
  double const time = state.clock.time - start;
  ASSERT_GT(time, 0.99);
  EXPECT_NEAR(row[0], std::hypot(1.5, 1.0) * time, 1e-12);
  EXPECT_NEAR(row[1], 3.25 * time * time, 1e-12);
}

TEST(Displacement, CountsEveryCrossingByTheSideThatWasCrossed) {
  State state = empty_state(Box(4, 9, Edge::periodic));  // √area = 6
  add_disk(state, {1, 1});
  add_disk(state, {1, 1});
  Displacement displacement;
  displacement.begin({state, {}});
  state.agents.column<ImageX>()[0] = 2;   // 8 to the right
  state.agents.column<ImageY>()[0] = -1;  // 9 down
  state.agents.column<Y>()[0] += 3.0;
  auto const row = sample(displacement, state);
  EXPECT_DOUBLE_EQ(row[0], 10.0 / 6.0 / 2.0);
  EXPECT_DOUBLE_EQ(row[1], 100.0 / 2.0);
  EXPECT_DOUBLE_EQ(row[2], 10.0 / 6.0 / 2.0);
}

TEST(Displacement, FollowsIdsWhenRowsAreReordered) {
  State const start = ideal_gas(Box(1, 1, Edge::periodic), 50, 0.01, 2);
  State end = ideal_gas(Box(1, 1, Edge::periodic), 50, 0.01, 3);
  end.agents.column<ImageX>()[7] = -3;
  Displacement straight;
  Displacement reversed;
  Displacement begun_reversed;
  straight.begin({start, {}});
  reversed.begin({start, {}});
  begun_reversed.begin({with_rows_reversed(start), {}});
  auto const row = sample(straight, end);
  ASSERT_GT(row[0], 0.0);
  auto const reversed_row = sample(reversed, with_rows_reversed(end));
  auto const begun_row = sample(begun_reversed, end);
  for (std::size_t c = 0; c < row.size(); ++c) {
    EXPECT_NEAR(reversed_row[c], row[c], 1e-14);
    EXPECT_NEAR(begun_row[c], row[c], 1e-14);
  }
  EXPECT_NEAR(*result(reversed, "mean_displacement")->error, *result(straight, "mean_displacement")->error, 1e-14);
}

TEST(Displacement, CountsOnlyDisksAliveSinceTheStart) {
  State state = empty_state(Box(1, 1, Edge::wall));
  Id const stays = add_disk(state, {0.1, 0.5});
  Id const dies = add_disk(state, {0.5, 0.5});
  Displacement displacement;
  displacement.begin({state, {}});
  state.agents.remove(dies);
  Id const born = add_disk(state, {0.9, 0.9});  // takes the slot of the dead one under a new name
  ASSERT_NE(born, dies);
  state.agents.column<X>()[state.agents.index_of(stays)] = 0.4;
  EXPECT_NEAR(sample(displacement, state)[0], 0.3, 1e-15);
}

TEST(Displacement, ErrorIsThatOfTheMeanOverSixteenBlocksOfDisks) {
  // Two disks a block, both moved by the number of their block: block means 0 … 15, variance of their mean
  // Σ(b − 7.5)²/(16·15) = 340/240.
  State state = empty_state(Box(100, 100, Edge::wall));
  for (int i = 0; i < 32; ++i) add_disk(state, {1, 1});
  Displacement displacement;
  displacement.begin({state, {}});
  for (std::size_t i = 0; i < 32; ++i) state.agents.column<X>()[i] += static_cast<double>(i / 2);
  sample(displacement, state, {}, false);
  auto const mean = result(displacement, "mean_displacement");
  ASSERT_TRUE(mean && mean->error);
  EXPECT_NEAR(mean->value, 0.075, 1e-15);
  EXPECT_NEAR(*mean->error, std::sqrt(340.0 / 240.0) / 100.0, 1e-15);
}

TEST(Displacement, ErrorIsUnbiasedForIndependentDisks) {
  // Squared displacements of normal steps have mean 2 and variance 4, so the variance of their mean over N is 4/N.
  constexpr std::size_t n = 100;  // no multiple of 16
  constexpr int replicas = 1000;
  double sum = 0.0;
  double squares = 0.0;
  for (int replica = 0; replica < replicas; ++replica) {
    State state = empty_state(Box(1000, 1000, Edge::wall));
    for (std::size_t i = 0; i < n; ++i) add_disk(state, {500, 500});
    Displacement displacement;
    displacement.begin({state, {}});
    for (std::size_t i = 0; i < n; ++i) {
      RandomStream random(5, static_cast<std::uint64_t>(replica), i, Purpose::start_position);
      state.agents.column<X>()[i] += random.normal();
      state.agents.column<Y>()[i] += random.normal();
    }
    sample(displacement, state);
    double const squared = std::pow(*result(displacement, "mean_squared_displacement")->error, 2);
    sum += squared / replicas;
    squares += squared * squared / replicas;
  }
  EXPECT_NEAR(sum, 4.0 / n, 4.0 * std::sqrt((squares - sum * sum) / replicas));
}

TEST(Displacement, OneDiskHasAValueWithoutErrorAndNoDisksHaveNone) {
  State state = empty_state(Box(1, 1, Edge::periodic));
  Displacement none;
  none.begin({state, {}});
  for (double const value : sample(none, state)) EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(none.results().empty());
  add_disk(state, {0.5, 0.5});
  Displacement one;
  one.begin({state, {}});
  sample(one, state);
  ASSERT_TRUE(result(one, "mean_displacement"));
  EXPECT_FALSE(result(one, "mean_displacement")->error);
}

}  // namespace
}  // namespace gridlock
