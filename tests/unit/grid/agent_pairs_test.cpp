// Pairs of agents near each other with numbers far from each other: memory is asked for before they are visited.

#include "gridlock/grid/detail/agent_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/sorted_grid.hpp"

namespace gridlock {
namespace {

/// Points on a lattice in a shuffled or in their own order.
struct Lattice {
  explicit Lattice(bool is_shuffled) {
    constexpr std::size_t side = 60;
    std::vector<std::size_t> sites(side * side);
    std::iota(sites.begin(), sites.end(), std::size_t{0});
    RandomStream random(1, 0, 0, Purpose::start_position);
    for (std::size_t k = sites.size(); is_shuffled && k > 1; --k) std::swap(sites[k - 1], sites[random.below(k)]);
    for (std::size_t const site : sites) {
      x.push_back((static_cast<double>(site % side) + 0.5) / side);
      y.push_back((static_cast<double>(site / side) + 0.5) / side);
    }
  }

  std::vector<double> x;
  std::vector<double> y;
};

constexpr double cutoff = 1.5 / 60;

template <class Grid>
void expect_pairs_ahead_where_scattered(Grid const& grid, bool is_shuffled) {
  using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;
  Pairs plain;
  grid.for_each_candidate_pair(cutoff, [&](std::size_t i, std::size_t j) { plain.emplace_back(i, j); });
  Pairs expected;
  Pairs visited;
  std::size_t ahead = 0;
  grid.for_each_candidate_pair(
      cutoff,
      [&](std::size_t i, std::size_t j) {
        visited.emplace_back(i, j);
        if (!is_shuffled) return;
        ASSERT_GE(expected.size(), visited.size());
        ahead = std::max(ahead, expected.size() - visited.size());
      },
      [&](std::size_t i, std::size_t j) { expected.emplace_back(i, j); });
  EXPECT_GT(plain.size(), 10'000U);
  EXPECT_EQ(visited, plain);
  EXPECT_EQ(expected, is_shuffled ? plain : Pairs());
  EXPECT_EQ(ahead > 16, is_shuffled);
}

TEST(AgentPairs, AreExpectedBeforeTheyAreVisitedWhereTheyAreScatteredAndOnlyThere) {
  Box const box(1.0, 1.0, Edge::wall);
  CellLayout const layout(box, 30, 30);
  for (bool const is_shuffled : {true, false}) {
    Lattice const points(is_shuffled);
    expect_pairs_ahead_where_scattered(PackedGrid(layout, points.x, points.y), is_shuffled);
    expect_pairs_ahead_where_scattered(SortedGrid(box, layout, points.x, points.y), is_shuffled);
  }
}

}  // namespace
}  // namespace gridlock
