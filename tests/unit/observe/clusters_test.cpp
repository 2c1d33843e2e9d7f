#include "gridlock/observe/clusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "observe/cluster_sizes.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

std::vector<std::uint32_t> clusters_of(State const& state, double cutoff) {
  Disks const& d = state.agents;
  return cluster_of_each(state.box, d.column<X>(), d.column<Y>(), d.column<Radius>(), cutoff);
}

/// Labels spread from neighbour to neighbour until none changes: slow, and sure.
std::vector<std::uint32_t> clusters_by_spreading(State const& state, double cutoff) {
  auto const x = state.agents.column<X>();
  auto const y = state.agents.column<Y>();
  auto const radius = state.agents.column<Radius>();
  std::vector<std::uint32_t> first(x.size());
  std::iota(first.begin(), first.end(), 0U);
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < x.size(); ++j) {
        double const distance = std::sqrt(squared_length(state.box.displacement({x[i], y[i]}, {x[j], y[j]})));
        if (first[j] >= first[i] || distance >= cutoff * (radius[i] + radius[j])) continue;
        first[i] = first[j];
        has_changed = true;
      }
    }
  }
  return first;
}

/// Whether two labellings join the same rows.
bool are_one_partition(std::vector<std::uint32_t> const& one, std::vector<std::uint32_t> const& other) {
  for (std::size_t i = 0; i < one.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((one[i] == one[j]) != (other[i] == other[j])) return false;
    }
  }
  return true;
}

TEST(ClusterOfEach, JoinsChainsOfNearDisksAndNumbersTheLargestFirst) {
  State state = empty_state(Box(8.0, 3.0, Edge::wall));
  for (double const x : {0.5, 3.0, 4.05, 5.0, 7.2}) add_disk(state, {x, 1.0}, {}, 0.5);
  EXPECT_EQ(clusters_of(state, 1.1), (std::vector<std::uint32_t>{1, 0, 0, 0, 2}));
  EXPECT_EQ(clusters_of(state, 1.0), (std::vector<std::uint32_t>{1, 2, 0, 0, 3})) << "3 and 4.05 are 1.05 apart";
  EXPECT_EQ(sizes_of_clusters(clusters_of(state, 1.1)), (std::vector<std::uint64_t>{3, 1, 1}));
}

TEST(ClusterOfEach, JoinsAcrossPeriodicEdgesButNotThroughWalls) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State state = empty_state(Box(6.0, 4.0, edge));
    add_disk(state, {0.5, 0.5}, {}, 0.5);
    add_disk(state, {5.5, 0.5}, {}, 0.5);
    add_disk(state, {0.5, 3.5}, {}, 0.5);
    std::size_t const expected = edge == Edge::periodic ? 1 : 3;
    EXPECT_EQ(sizes_of_clusters(clusters_of(state, 1.1)).size(), expected);
  }
}

TEST(ClusterOfEach, MeasuresDistanceInTheSumOfTheTwoRadii) {
  State state = empty_state(Box(9.0, 4.0, Edge::wall));
  add_disk(state, {2.0, 2.0}, {}, 1.0);
  add_disk(state, {3.3, 2.0}, {}, 0.2);   // 1.3 from the first, below 1.1 · 1.2
  add_disk(state, {3.75, 2.0}, {}, 0.2);  // 0.45 from the second, above 1.1 · 0.4
  EXPECT_EQ(clusters_of(state, 1.1), (std::vector<std::uint32_t>{0, 0, 1}));
}

TEST(ClusterOfEach, FindsTheClustersOfASlowSearchInOblongBoxesOfAnyEdgeAndDensity) {
  int splits = 0;
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (Vector const sides : {Vector{9.0, 4.0}, Vector{2.5, 30.0}, Vector{0.9, 40.0}}) {
      for (std::size_t const count : {0U, 1U, 2U, 30U, 150U}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
          State state = ideal_gas(Box(sides.x, sides.y, edge), count, 0.2, seed);
          auto radius = state.agents.column<Radius>();
          for (std::size_t i = 0; i < count; ++i) radius[i] = i % 3 == 0 ? 0.3 : 0.12;
          std::vector<std::uint32_t> const found = clusters_of(state, 1.1);
          EXPECT_TRUE(are_one_partition(found, clusters_by_spreading(state, 1.1))) << sides.x << " " << count;
          std::vector<std::uint64_t> const sizes = sizes_of_clusters(found);
          EXPECT_TRUE(std::ranges::is_sorted(sizes, std::greater<>()));
          splits += sizes.size() > 1 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(splits, 50) << "else the comparison says little";
}

/// The share and size of clusters and their table, of one sample.
struct Measured {
  std::vector<double> row;
  std::vector<std::vector<double>> table;
};

Measured measured_clusters(State const& state) {
  ClusterSizes clusters(1, 1.1);
  clusters.begin({state, {}});
  std::vector<double> row = sample(clusters, state);
  auto const distributions = clusters.distributions();
  return {std::move(row),
          distributions.empty() ? std::vector<std::vector<double>>{} : distributions[0].columns_of_values};
}

TEST(ClusterSizes, TellTheLargestTheMeanAndTheNumberOfEachSize) {
  State state = empty_state(Box(30.0, 3.0, Edge::wall));
  double x = 0.5;
  for (std::size_t const size : {3U, 1U, 3U, 1U, 2U}) {
    for (std::size_t k = 0; k < size; ++k) add_disk(state, {x += 1.05, 1.0}, {}, 0.5);
    x += 1.0;
  }
  Measured const found = measured_clusters(state);
  EXPECT_EQ(found.row, (std::vector<double>{0.3, 2.0}));
  EXPECT_EQ(found.table[0], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(found.table[1], (std::vector<double>{2, 1, 2}));
  EXPECT_EQ(found.table[3], (std::vector<double>{0.2, 0.2, 0.6}));
  EXPECT_EQ(found.table[4], (std::vector<double>{1, 2, 3}));
}

TEST(ClusterSizes, RangesOfSizesFollowOneAnotherAndHoldEveryDisk) {
  State state = empty_state(Box(400.0, 3.0, Edge::wall));
  for (int k = 0; k < 137; ++k) add_disk(state, {1.0 + 1.01 * k, 1.0}, {}, 0.5);
  add_disk(state, {300.0, 1.0}, {}, 0.5);
  auto const table = measured_clusters(state).table;
  for (std::size_t k = 1; k < table[0].size(); ++k) EXPECT_EQ(table[0][k], table[4][k - 1] + 1.0);
  EXPECT_LE(table[0].back(), 137.0);
  EXPECT_GE(table[4].back(), 137.0);
  EXPECT_EQ(table[1].back(), 1.0);
  EXPECT_EQ(table[1].front(), 1.0);
  EXPECT_NEAR(std::accumulate(table[3].begin(), table[3].end(), 0.0), 1.0, 1e-15);
}

TEST(ClusterSizes, ARangeThatAppearsLaterCountsAsEmptyBefore) {
  State apart = empty_state(Box(9.0, 3.0, Edge::wall));
  State joined = empty_state(Box(9.0, 3.0, Edge::wall));
  for (double const x : {1.0, 4.0}) add_disk(apart, {x, 1.0}, {}, 0.5);
  for (double const x : {1.0, 2.0}) add_disk(joined, {x, 1.0}, {}, 0.5);
  ClusterSizes clusters(1, 1.1);
  clusters.begin({apart, {}});
  for (int k = 0; k < 3; ++k) sample(clusters, apart);
  sample(clusters, joined);
  auto const table = clusters.distributions()[0].columns_of_values;
  EXPECT_EQ(table[1], (std::vector<double>{1.5, 0.25}));
  EXPECT_NEAR(table[2][1], 0.25, 1e-15) << "of 0, 0, 0, 1";
}

TEST(ClusterSizes, LeaveFixedDisksOut) {
  State state = empty_state(Box(9.0, 3.0, Edge::wall));
  add_disk(state, {1.0, 1.0}, {}, 0.5);
  add_disk(state, {2.0, 1.0}, {}, 0.5, std::numeric_limits<double>::infinity());
  add_disk(state, {3.0, 1.0}, {}, 0.5);
  EXPECT_EQ(measured_clusters(state).row, (std::vector<double>{0.5, 1.0}));
}

}  // namespace
}  // namespace gridlock
