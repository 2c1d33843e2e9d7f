// Every grid finds what brute force finds: pairs and neighbours, in any box, for any points, at any time of a life of
// inserts, moves and erases.

#include "grid/pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "grid/candidate_pairs.hpp"
#include "grid/linked_grid.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/sorted_grid.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/neighbour_search.hpp"

namespace gridlock {
namespace {

using Separations = std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>>;

Separations separations_by_brute_force(State const& state, double cutoff) {
  Separations pairs;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Vector const d = state.box.displacement(position(state.agents, i), position(state.agents, j));
      if (squared_length(d) < cutoff * cutoff) pairs[{i, j}] = {d.x, d.y};
    }
  }
  return pairs;
}

template <class Grid>
Separations separations_by_grid(State const& state, Grid const& grid, double cutoff) {
  Separations pairs;
  for_each_pair(state, grid, cutoff, [&](std::size_t i, std::size_t j, Vector d) {
    EXPECT_GT(i, j);
    EXPECT_TRUE(pairs.emplace(std::pair{i, j}, std::pair{d.x, d.y}).second) << "the pair came twice";
  });
  return pairs;
}

template <class Grid>
Separations pairs_by_neighbours(State const& state, Grid const& grid, double cutoff) {
  Separations pairs;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    for_each_neighbour(state, grid, cutoff, i, [&](std::size_t j, Vector d) {
      EXPECT_NE(i, j);
      if (j < i) {
        EXPECT_TRUE(pairs.emplace(std::pair{i, j}, std::pair{d.x, d.y}).second) << "the neighbour came twice";
      }
    });
  }
  return pairs;
}

class Scene {
 public:
  explicit Scene(std::uint64_t seed) : random_(seed, 0, 0, Purpose::start_position) {
    Edge const edge_x = random_.below(2) == 0 ? Edge::wall : Edge::periodic;
    Edge const edge_y = random_.below(2) == 0 ? Edge::wall : Edge::periodic;
    // From a square to a strip; units from tiny to huge.
    double const unit = std::array{1e-12, 1.0, 1e9}[random_.below(3)];
    double const flat = random_.below(4) == 0 ? 0.01 : 1.0;
    state_.box = Box(unit * (0.2 + random_.uniform()), flat * unit * (0.2 + random_.uniform()), edge_x, edge_y);
    cluster_ = random_.below(3) == 0 ? 0.1 : 1.0;
    where_ = std::array{Where::inside, Where::centred, Where::boxes_away, Where::far_away}[random_.below(4)];
    std::uint64_t const count = random_.below(80);
    for (std::uint64_t n = 0; n < count; ++n) add();
  }

  State& state() { return state_; }
  RandomStream& random() { return random_; }

  [[nodiscard]] double any_cutoff() {
    double const shorter = std::min(state_.box.width(), state_.box.height());
    // Often nearly half a side, where the two ways around a periodic box are equally long.
    return (random_.below(4) == 0 ? 0.49995 : 0.001 + 0.499 * random_.uniform()) * shorter;
  }
  CellLayout any_layout(double cutoff) {
    if (random_.below(2) == 0) return layout_for_cutoff(state_.box, cutoff, state_.agents.size());
    return {state_.box, 1 + random_.below(9), 1 + random_.below(9)};
  }
  /// A point, often on borders of cells and of the box; in most periodic boxes one of its images outside, between walls
  /// sometimes outside; often one that there is already, or one half a box from it.
  Vector any_point() {
    if (!state_.agents.empty() && random_.below(8) == 0) {
      return position(state_.agents, static_cast<std::size_t>(random_.below(state_.agents.size())));
    }
    if (state_.box.has_images() && where_ == Where::inside && !state_.agents.empty() && random_.below(8) == 0) {
      // Almost half a side from another one.
      Vector p = position(state_.agents, static_cast<std::size_t>(random_.below(state_.agents.size())));
      bool const is_along_x = random_.below(2) == 0;
      double& coordinate = is_along_x ? p.x : p.y;
      double const half = 0.4999 * (is_along_x ? state_.box.width() : state_.box.height());
      coordinate += coordinate < half ? half : -half;
      return p;
    }
    return {coordinate(state_.box.width(), state_.box.is_periodic_x()),
            coordinate(state_.box.height(), state_.box.is_periodic_y())};
  }
  void add() {
    Vector const p = any_point();
    state_.agents.add(p.x, p.y, 0, 0, 1, 1, 0, 0);
  }

 private:
  /// Where the points of a periodic box are.
  enum class Where { inside, centred, boxes_away, far_away };

  double coordinate(double side, bool is_periodic) {
    double p = cluster_ * random_.uniform() * side;
    if (random_.below(4) == 0) p = static_cast<double>(random_.below(13)) / 12.0 * side;
    if (!is_periodic) return random_.below(16) == 0 ? p + side * (8.0 * random_.uniform() - 4.0) : p;
    // Close to an edge of the box, where a coordinate and its image round differently.
    if (where_ != Where::inside && random_.below(16) == 0) {
      p = (static_cast<double>(random_.below(9)) - 4.0) * 1e-17 * side;
    }
    switch (where_) {
      case Where::inside:
        return p >= side ? 0.0 : p;
      case Where::centred:
        return p - 0.5 * side;
      case Where::boxes_away:
        return p + (static_cast<double>(random_.below(9)) - 4.0) * side;
      case Where::far_away:
        return p + (random_.below(2) == 0 ? 1.0 : -1.0) * static_cast<double>(random_.below(1000000)) * side;
    }
    return p;
  }

  State state_;
  RandomStream random_;
  double cluster_ = 1.0;
  Where where_ = Where::inside;
};

template <class Grid>
class PairsOnGrid : public testing::Test {};
using Grids = testing::Types<LinkedGrid, PackedGrid>;
TYPED_TEST_SUITE(PairsOnGrid, Grids);

TYPED_TEST(PairsOnGrid, AreThoseOfBruteForce) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Scene scene(seed);
    State const& state = scene.state();
    double const cutoff = scene.any_cutoff();
    TypeParam const grid(scene.any_layout(cutoff), state.agents.column<X>(), state.agents.column<Y>());
    Separations const expected = separations_by_brute_force(state, cutoff);
    ASSERT_TRUE(grid.is_consistent()) << "seed " << seed;
    ASSERT_EQ(separations_by_grid(state, grid, cutoff), expected) << "seed " << seed;
    ASSERT_EQ(pairs_by_neighbours(state, grid, cutoff), expected) << "seed " << seed;
  }
}

TYPED_TEST(PairsOnGrid, StayThoseOfBruteForceThroughBirthsMovesAndDeaths) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Scene scene(seed);
    State& state = scene.state();
    RandomStream& random = scene.random();
    double const cutoff = scene.any_cutoff();
    TypeParam grid(scene.any_layout(cutoff), state.agents.column<X>(), state.agents.column<Y>());
    for (int n = 0; n < 60; ++n) {
      std::uint64_t const what = random.below(4);
      if (what == 0 || state.agents.empty()) {
        scene.add();
        grid.insert(state.agents.size() - 1, position(state.agents, state.agents.size() - 1));
      } else if (what == 1) {
        // The last row takes the place of the dead.
        auto const row = static_cast<std::size_t>(random.below(state.agents.size()));
        std::size_t const last = state.agents.size() - 1;
        grid.erase(row);
        if (row != last) {
          grid.erase(last);
          grid.insert(row, position(state.agents, last));
        }
        state.agents.remove(state.agents.ids()[row]);
      } else {
        auto const row = static_cast<std::size_t>(random.below(state.agents.size()));
        Vector const p = scene.any_point();
        state.agents.column<X>()[row] = p.x;
        state.agents.column<Y>()[row] = p.y;
        what == 2 ? grid.move(row, p) : grid.move_all(state.agents.column<X>(), state.agents.column<Y>());
      }
      ASSERT_EQ(grid.size(), state.agents.size());
      ASSERT_TRUE(grid.is_consistent()) << "seed " << seed << ", operation " << n;
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        ASSERT_EQ(grid.cell_of(i), grid.layout().cell_of(position(state.agents, i))) << "seed " << seed;
      }
    }
    ASSERT_EQ(separations_by_grid(state, grid, cutoff), separations_by_brute_force(state, cutoff)) << "seed " << seed;
  }
}

TYPED_TEST(PairsOnGrid, NeighboursOfAPointAreTheDisksWithinTheCutoff) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Scene scene(seed);
    State const& state = scene.state();
    double const cutoff = scene.any_cutoff();
    TypeParam const grid(scene.any_layout(cutoff), state.agents.column<X>(), state.agents.column<Y>());
    Vector const p = scene.any_point();
    std::set<std::size_t> found;
    for_each_neighbour(state, grid, cutoff, p, [&](std::size_t j, Vector d) {
      EXPECT_EQ(d, state.box.displacement(p, position(state.agents, j)));
      EXPECT_TRUE(found.insert(j).second);
    });
    std::set<std::size_t> expected;
    for (std::size_t j = 0; j < state.agents.size(); ++j) {
      if (squared_length(state.box.displacement(p, position(state.agents, j))) < cutoff * cutoff) expected.insert(j);
    }
    ASSERT_EQ(found, expected) << "seed " << seed;
  }
}

TEST(NeighboursOnPackedGrid, ComeInTheOrderOfTheBlockOfCells) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Scene scene(seed);
    State const& state = scene.state();
    double const cutoff = scene.any_cutoff();
    PackedGrid const grid(scene.any_layout(cutoff), state.agents.column<X>(), state.agents.column<Y>());
    Vector const p = scene.any_point();
    std::vector<std::size_t> found;
    for_each_neighbour(state, grid, cutoff, p, [&](std::size_t j, Vector) { found.push_back(j); });
    std::vector<std::size_t> expected;
    CellLayout const& layout = grid.layout();
    grid.for_each_in_block(layout.cell_of(p), layout.columns_within(cutoff), layout.rows_within(cutoff),
                           [&](std::size_t j) {
                             Vector const d = state.box.displacement(p, position(state.agents, j));
                             if (squared_length(d) < cutoff * cutoff) expected.push_back(j);
                           });
    ASSERT_EQ(found, expected) << "seed " << seed;
  }
}

using CandidatePairs = std::vector<AgentPair>;

CandidatePairs candidate_pairs(PackedGrid const& grid, double cutoff, AddPairsOfRow kernel) {
  CandidatePairs all;
  find_candidate_pairs(grid, cutoff, kernel,
                       [&](std::span<AgentPair const> pairs) { all.insert(all.end(), pairs.begin(), pairs.end()); });
  return all;
}

TEST(CandidatePairs, AreTheSameInTheSameOrderWithAnyInstructions) {
  for (std::uint64_t seed = 0; seed < 3000; ++seed) {
    Scene scene(seed);
    State const& state = scene.state();
    double const cutoff = scene.any_cutoff();
    PackedGrid const grid(scene.any_layout(cutoff), state.agents.column<X>(), state.agents.column<Y>());
    CandidatePairs const expected = candidate_pairs(grid, cutoff, add_pairs_of_row_scalar);
    for (Target const target : available_targets()) {
      ASSERT_EQ(candidate_pairs(grid, cutoff, add_pairs_kernel(target)), expected)
          << "seed " << seed << ", " << to_text(target);
    }
  }
}

/// Some columns or rows, none to all of them.
std::pair<int, int> any_stretch(RandomStream& random, int all) {
  int const first = static_cast<int>(random.below(static_cast<std::uint64_t>(all)));
  return {first, first + static_cast<int>(random.below(static_cast<std::uint64_t>(all - first) + 1))};
}

TEST(CandidatePairs, OfAWindowHoldThoseOfTheAgentsWhoseBlocksItHas) {
  std::size_t pairs_seen = 0;
  for (std::uint64_t seed = 0; seed < 4500; ++seed) {
    Scene scene(seed);
    State const& state = scene.state();
    double const cutoff = scene.any_cutoff();
    CellLayout const layout = scene.any_layout(cutoff);
    auto const [first_column, end_column] = any_stretch(scene.random(), layout.columns());
    auto const [first_row, end_row] = any_stretch(scene.random(), layout.rows());
    int const columns = layout.columns_within(cutoff);
    int const rows = layout.rows_within(cutoff);
    PackedGrid grid(layout,
                    within(layout, {.first_column = first_column - columns,
                                    .end_column = end_column + columns,
                                    .first_row = first_row - rows,
                                    .end_row = end_row + rows}),
                    state.agents.size());
    std::vector<bool> is_inside;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const p = position(state.agents, i);
      Vector const image = layout.image_in_cell(p);
      int const column = layout.column_of(image.x);
      int const row = layout.row_of(image.y);
      is_inside.push_back(column >= first_column && column < end_column && row >= first_row && row < end_row);
      if (grid.stores(column, row)) grid.insert(i, p);
    }
    auto const of_those_inside = [&](Separations all) {
      std::erase_if(all,
                    [&](auto const& pair) { return !is_inside[pair.first.first] && !is_inside[pair.first.second]; });
      return all;
    };
    Separations const expected = of_those_inside(separations_by_brute_force(state, cutoff));
    pairs_seen += expected.size();
    ASSERT_EQ(of_those_inside(separations_by_grid(state, grid, cutoff)), expected) << "seed " << seed;
    CandidatePairs const by_scalar = candidate_pairs(grid, cutoff, add_pairs_of_row_scalar);
    for (Target const target : available_targets()) {
      ASSERT_EQ(candidate_pairs(grid, cutoff, add_pairs_kernel(target)), by_scalar)
          << "seed " << seed << ", " << to_text(target);
    }
  }
  EXPECT_GT(pairs_seen, 100'000U);
}

TEST(CandidatePairs, AreTheSameWhereEveryCellIsFullAndEveryAgentIsNear) {
  // Four coincident agents at the middle of each cell: 3 + 16 pairs for the first of each.
  State state{.box = Box(20.0, 20.0, Edge::periodic)};
  for (int n = 0; n < 1600; ++n) {
    state.agents.add(0.5 + n / 4 % 20, 0.5 + n / 80, 0, 0, 1, 1, 0, 0);
  }
  PackedGrid const grid({state.box, 10, 10}, state.agents.column<X>(), state.agents.column<Y>());
  PackedGrid const fine({state.box, 20, 20}, state.agents.column<X>(), state.agents.column<Y>());
  for (PackedGrid const* one : {&grid, &fine}) {
    double const cutoff = one->layout().cell_width();
    CandidatePairs const expected = candidate_pairs(*one, cutoff, add_pairs_of_row_scalar);
    for (Target const target : available_targets()) {
      EXPECT_EQ(candidate_pairs(*one, cutoff, add_pairs_kernel(target)), expected) << to_text(target);
    }
    EXPECT_EQ(separations_by_grid(state, *one, cutoff), separations_by_brute_force(state, cutoff));
    EXPECT_GT(expected.size(), 1600U * 8U);
  }
}

TEST(NeighbourSearch, FindsWhatBruteForceFindsBeforeAndAfterPointsMove) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Scene scene(seed);
    State& state = scene.state();
    double const cutoff = scene.any_cutoff();
    NeighbourSearch search(state.box, cutoff, state.agents.column<X>(), state.agents.column<Y>());
    for (int round = 0; round < 3; ++round) {
      Separations by_pairs, by_neighbours;
      search.for_each_pair([&](std::size_t i, std::size_t j, Vector d) {
        ASSERT_GT(i, j);
        ASSERT_TRUE(by_pairs.emplace(std::pair{i, j}, std::pair{d.x, d.y}).second) << "the pair came twice";
      });
      for (std::size_t i = 0; i < search.size(); ++i) {
        search.for_each_neighbour(i, [&](std::size_t j, Vector d) {
          ASSERT_NE(j, i);
          if (j < i) by_neighbours[{i, j}] = {d.x, d.y};
        });
      }
      Separations const expected = separations_by_brute_force(state, cutoff);
      ASSERT_EQ(by_pairs, expected) << "seed " << seed;
      ASSERT_EQ(by_neighbours, expected) << "seed " << seed;
      for (std::size_t i = 0; i < search.size(); ++i) {
        Vector const p = scene.any_point();
        state.agents.column<X>()[i] = p.x;
        state.agents.column<Y>()[i] = p.y;
      }
      search.update(state.agents.column<X>(), state.agents.column<Y>());
    }
  }
}

TEST(PairsOnSortedGrid, AreThoseOfBruteForceBeforeAndAfterPointsMove) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    Scene scene(seed);
    State& state = scene.state();
    double const cutoff = scene.any_cutoff();
    CellLayout const layout = layout_for_cutoff(state.box, cutoff, state.agents.size(), 64.0);
    SortedGrid grid(state.box, layout, state.agents.column<X>(), state.agents.column<Y>());
    for (int round = 0; round < 3; ++round) {
      Separations const expected = separations_by_brute_force(state, cutoff);
      ASSERT_EQ(separations_by_grid(state, grid, cutoff), expected) << "seed " << seed;
      ASSERT_EQ(pairs_by_neighbours(state, grid, cutoff), expected) << "seed " << seed;
      SortedGrid const before = grid;
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        Vector const p = scene.any_point();
        state.agents.column<X>()[i] = p.x;
        state.agents.column<Y>()[i] = p.y;
      }
      // Copies know nothing of each other.
      if (round == 1) grid = SortedGrid(before);
      grid.move_all(state.agents.column<X>(), state.agents.column<Y>());
    }
  }
}

TEST(PairsOnSortedGrid, AreThoseOfBruteForceWhileFewPointsMove) {
  std::size_t moved = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Scene scene(seed);
    State& state = scene.state();
    RandomStream random(seed, 1, 0, Purpose::start_position);
    double const cutoff = scene.any_cutoff();
    CellLayout const layout = layout_for_cutoff(state.box, cutoff, state.agents.size(), 64.0);
    SortedGrid grid(state.box, layout, state.agents.column<X>(), state.agents.column<Y>());
    for (int round = 0; round < 5; ++round) {
      double const share = std::array{0.0, 0.03, 0.1, 0.5}[random.below(4)];
      for (std::size_t i = 0; i < state.agents.size(); ++i) {
        if (random.uniform() >= share) continue;
        Vector const p = scene.any_point();
        state.agents.column<X>()[i] = p.x;
        state.agents.column<Y>()[i] = p.y;
        ++moved;
      }
      grid.move_all(state.agents.column<X>(), state.agents.column<Y>());
      Separations const expected = separations_by_brute_force(state, cutoff);
      ASSERT_EQ(separations_by_grid(state, grid, cutoff), expected) << "seed " << seed << ", round " << round;
      ASSERT_EQ(pairs_by_neighbours(state, grid, cutoff), expected) << "seed " << seed << ", round " << round;
    }
  }
  EXPECT_GT(moved, 5000U);
}

/// Most points in a small part of the box, in an image of it if the box is periodic: some at the same place, some
/// exactly one cutoff apart, and a few everywhere else.
State crowd(Box const& box, std::size_t count, double cutoff, RandomStream& random) {
  State state{.box = box};
  Vector const corner{0.9 * random.uniform() * box.width(), 0.9 * random.uniform() * box.height()};
  double const boxes_away = box.is_periodic_x() ? static_cast<double>(random.below(3)) : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    Vector p{random.uniform() * box.width(), random.uniform() * box.height()};
    // Of side 7.5 cutoffs: about as many neighbours each as points per 18 squared cutoffs.
    if (random.below(10) != 0)
      p = corner + 0.5 * cutoff * Vector{static_cast<double>(random.below(16)), 7.5 * random.uniform()};
    state.agents.add(p.x + boxes_away * box.width(), p.y, 0, 0, 1, 1, 0, 0);
  }
  return state;
}

void expect_lists(State const& state, double cutoff, Separations const& expected) {
  PointsInMemory const points{
      .x = state.agents.column<X>().data(), .y = state.agents.column<Y>().data(), .count = state.agents.size()};
  for (std::uint64_t const threads : {1U, 3U}) {
    PointPairs const pairs = find_pairs(state.box, cutoff, points, threads);
    std::set<std::pair<std::size_t, std::size_t>> found;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      found.insert({std::max(pairs.first()[k], pairs.second()[k]), std::min(pairs.first()[k], pairs.second()[k])});
    }
    ASSERT_EQ(found.size(), pairs.size()) << "a pair came twice";
    ASSERT_EQ(found.size(), expected.size());
    for (auto const& [pair, separation] : expected) ASSERT_TRUE(found.contains(pair));
    NeighbourLists const lists = find_neighbour_lists(state.box, cutoff, points, threads);
    ASSERT_EQ(lists.neighbours.size(), 2 * expected.size());
  }
}

TEST(NeighbourSearch, FindsWhatBruteForceFindsWherePointsCrowdComeTogetherAndDisperse) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    Edge const edge_x = random.below(2) == 0 ? Edge::wall : Edge::periodic;
    Box const box(1.0 + random.uniform(), 1.0, edge_x, seed % 3 == 0 ? Edge::wall : edge_x);
    std::size_t const count = 200 + random.below(300);
    double const cutoff = std::array{0.002, 0.005, 0.02}[random.below(3)];
    std::array<State, 3> const states{crowd(box, count, cutoff, random), crowd(box, count, 20.0 * cutoff, random),
                                      crowd(box, count, cutoff, random)};
    // Spread widely they are no crowd.
    std::size_t const first = random.below(2);
    NeighbourSearch search(box, cutoff, states[first].agents.column<X>(), states[first].agents.column<Y>());
    for (std::size_t n = first; n < states.size(); ++n) {
      State const& state = states[n];
      search.update(state.agents.column<X>(), state.agents.column<Y>());
      Separations const expected = separations_by_brute_force(state, cutoff);
      Separations by_pairs, by_neighbours;
      search.for_each_pair([&](std::size_t i, std::size_t j, Vector d) {
        ASSERT_TRUE(by_pairs.emplace(std::pair{i, j}, std::pair{d.x, d.y}).second) << "the pair came twice";
      });
      for (std::size_t i = 0; i < search.size(); ++i) {
        search.for_each_neighbour(i, [&](std::size_t j, Vector d) {
          if (j < i) by_neighbours[{i, j}] = {d.x, d.y};
        });
      }
      ASSERT_EQ(by_pairs, expected) << "seed " << seed;
      ASSERT_EQ(by_neighbours, expected) << "seed " << seed;
      // Points outside a periodic box are sorted by their images, whose distances round otherwise.
      if (!box.has_images()) expect_lists(state, cutoff, expected);
    }
  }
}

TEST(PairsBetweenGrids, AreTheSameForThousandsOfAgents) {
  for (Box const& box : {Box(3.0, 2.0, Edge::wall), Box(3.0, 2.0, Edge::periodic),
                         Box(3.0, 2.0, Edge::periodic, Edge::wall), Box(3.0, 2.0, Edge::wall, Edge::periodic)}) {
    State state{.box = box};
    RandomStream random(7, 0, 0, Purpose::start_position);
    for (int n = 0; n < 20000; ++n) state.agents.add(3.0 * random.uniform(), 2.0 * random.uniform(), 0, 0, 1, 1, 0, 0);
    for (double const cutoff : {0.003, 0.02, 0.05}) {
      Separations const linked = separations_by_grid(state, grid_for_cutoff<LinkedGrid>(state, cutoff), cutoff);
      EXPECT_EQ(separations_by_grid(state, grid_for_cutoff<PackedGrid>(state, cutoff), cutoff), linked);
      EXPECT_GT(linked.size(), 500U);
    }
  }
}

}  // namespace
}  // namespace gridlock
