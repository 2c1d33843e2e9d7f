#include "observe/rates.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

/// A run of four disks of which only clock and counters change.
struct SyntheticRun {
  explicit SyntheticRun(Edge edge) : state(ideal_gas(Box(1, 1, edge), 4, 0.1, 1)) {
    // A run may go on from an earlier one.
    state.clock.time = 10.0;
    counters = {.moves = 50, .halted_moves = 20, .pair_collisions = 7, .wall_hits = {1, 2, 3, 4}};
  }
  void pass(double time, std::uint64_t collisions, std::uint64_t hits, std::uint64_t turns, std::uint64_t halted) {
    state.clock.time += time;
    counters.pair_collisions += collisions;
    counters.wall_hits[hits % 4] += hits;
    counters.moves += turns;
    counters.halted_moves += halted;
  }
  State state;
  Counters counters;
};

TEST(Rates, AreDifferencesOfTheCountersPerDiskAndTime) {
  SyntheticRun run(Edge::wall);
  Rates rates;
  rates.begin({run.state, run.counters});
  run.pass(2.0, 12, 5, 100, 25);
  auto const row = sample(rates, run.state, run.counters);
  EXPECT_DOUBLE_EQ(cell(rates, row, "collision_rate"), 2.0 * 12 / (4 * 2.0));
  EXPECT_DOUBLE_EQ(cell(rates, row, "mean_free_time"), 4 * 2.0 / (2.0 * 12));
  EXPECT_DOUBLE_EQ(cell(rates, row, "wall_hit_rate"), 5 / (4 * 2.0));
  EXPECT_DOUBLE_EQ(cell(rates, row, "halted_fraction"), 0.25);
}

TEST(Rates, AveragesAreRatiosOfSumsOverIntervalsOfAnyLength) {
  SyntheticRun run(Edge::wall);
  Rates rates;
  rates.begin({run.state, run.counters});
  run.pass(5.0, 1000, 1000, 10, 10);
  sample(rates, run.state, run.counters, false);  // must not enter
  run.pass(1.0, 10, 4, 100, 50);
  sample(rates, run.state, run.counters);
  run.pass(3.0, 0, 0, 350, 0);  // an interval without collisions counts with its time
  EXPECT_TRUE(std::isnan(cell(rates, sample(rates, run.state, run.counters), "mean_free_time")));
  run.pass(1.0, 5, 6, 150, 0);
  sample(rates, run.state, run.counters);
  EXPECT_DOUBLE_EQ(result(rates, "collision_rate")->value, 2.0 * 15 / (4 * 5.0));
  EXPECT_DOUBLE_EQ(result(rates, "wall_hit_rate")->value, 10 / (4 * 5.0));
  EXPECT_DOUBLE_EQ(result(rates, "halted_fraction")->value, 50.0 / 600.0);
  Estimate const rate = *result(rates, "collision_rate");
  Estimate const free_time = *result(rates, "mean_free_time");
  EXPECT_DOUBLE_EQ(free_time.value, 1.0 / rate.value);
  EXPECT_DOUBLE_EQ(*free_time.error / free_time.value, *rate.error / rate.value);
}

TEST(Rates, IndependentCollisionsHaveTheErrorOfTheirNumber) {
  // 32 intervals of binomial counts, 1000 trials with probability 1/16: mean M = 32 · 62.5 = 2000, variance 15/16 M, so
  // the squared relative error has the expectation 15/16 / M.
  constexpr int replicas = 200;
  double sum = 0.0;
  double squares = 0.0;
  for (int replica = 0; replica < replicas; ++replica) {
    SyntheticRun run(Edge::periodic);
    Rates rates;
    rates.begin({run.state, run.counters});
    RandomStream random(6, static_cast<std::uint64_t>(replica), 0, Purpose::start_position);
    for (int n = 0; n < 32; ++n) {
      std::uint64_t collisions = 0;
      for (int trial = 0; trial < 1000; ++trial) collisions += random.below(16) == 0 ? 1 : 0;
      run.pass(1.0, collisions, 0, 1, 0);
      sample(rates, run.state, run.counters);
    }
    // The error of the rate against the true rate 2 · 62.5 / 4.
    double const squared = std::pow(*result(rates, "collision_rate")->error / 31.25, 2);
    sum += squared / replicas;
    squares += squared * squared / replicas;
  }
  EXPECT_NEAR(sum, 15.0 / 16.0 / 2000.0, 4.0 * std::sqrt((squares - sum * sum) / replicas));
}

TEST(Rates, OfNoTimeNoTurnsOrNoDisksAreUndefined) {
  SyntheticRun run(Edge::wall);
  Rates rates;
  rates.begin({run.state, run.counters});
  for (double const value : sample(rates, run.state, run.counters)) EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(rates.results().empty());
  State nobody = empty_state(Box(1, 1, Edge::wall));
  rates.begin({nobody, {}});
  nobody.clock.time = 1.0;
  for (double const value : sample(rates, nobody)) EXPECT_TRUE(std::isnan(value));
  EXPECT_TRUE(rates.results().empty());
}

TEST(Rates, WithoutTurnsThereIsNoHaltedFractionWhateverTheCountersSayOfMoves) {
  SyntheticRun run(Edge::wall);
  Rates rates(false);
  rates.begin({run.state, run.counters});
  run.pass(1.0, 10, 4, 100, 0);
  EXPECT_TRUE(std::isnan(cell(rates, sample(rates, run.state, run.counters), "halted_fraction")));
  EXPECT_FALSE(result(rates, "halted_fraction"));
  EXPECT_TRUE(result(rates, "collision_rate"));
}

TEST(Rates, WithoutCollisionsThereIsARateOfZeroButNoMeanFreeTime) {
  SyntheticRun run(Edge::wall);
  Rates rates;
  rates.begin({run.state, run.counters});
  run.pass(1.0, 0, 0, 4, 0);
  sample(rates, run.state, run.counters);
  EXPECT_EQ(result(rates, "collision_rate")->value, 0.0);
  EXPECT_FALSE(result(rates, "mean_free_time"));
}

TEST(Rates, PeriodicBoxesHaveNoWalls) {
  SyntheticRun run(Edge::periodic);
  Rates rates;
  rates.begin({run.state, run.counters});
  for (ColumnInfo const& column : rates.columns()) EXPECT_EQ(column.name.find("wall"), std::string::npos);
}

}  // namespace
}  // namespace gridlock
