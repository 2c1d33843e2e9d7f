#include "grid/pairs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "grid/linked_grid.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {
namespace {

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

Pairs pairs_within(State const& state, double cutoff) {
  Pairs pairs;
  for_each_pair(state, grid_for_cutoff(state, cutoff), cutoff, [&](std::size_t i, std::size_t j, Vector separation) {
    EXPECT_GT(i, j);
    EXPECT_EQ(separation, state.box.displacement(position(state.agents, i), position(state.agents, j)));
    EXPECT_TRUE(pairs.emplace(i, j).second) << "a pair came twice";
  });
  return pairs;
}

State points(Edge edge, std::initializer_list<Vector> where) {
  State state{.box = Box(1.0, 1.0, edge)};
  for (Vector const p : where) state.agents.add(p.x, p.y, 0.0, 0.0, 0.01, 1.0, 0, 0);
  return state;
}

TEST(ForEachPair, FindsPairsAcrossTheEdgeOfAPeriodicBoxOnly) {
  std::initializer_list<Vector> const where{{0.02, 0.02}, {0.98, 0.02}, {0.02, 0.98}, {0.98, 0.98}};
  EXPECT_EQ(pairs_within(points(Edge::wall, where), 0.1), Pairs{});
  EXPECT_EQ(pairs_within(points(Edge::periodic, where), 0.1), (Pairs{{1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}}));
}

TEST(ForEachPair, TheCutoffItselfIsOutside) {
  State const state = points(Edge::wall, {{0.25, 0.5}, {0.5, 0.5}, {0.75, 0.5}});
  EXPECT_EQ(pairs_within(state, 0.25), Pairs{});
  EXPECT_EQ(pairs_within(state, 0.2500000001), (Pairs{{1, 0}, {2, 1}}));
}

TEST(ForEachPair, FindsCoincidentPoints) {
  EXPECT_EQ(pairs_within(points(Edge::periodic, {{0.5, 0.5}, {0.5, 0.5}, {0.5, 0.5}}), 1e-6),
            (Pairs{{1, 0}, {2, 0}, {2, 1}}));
}

TEST(ForEachPair, HasNothingToSayAboutNoneOrOne) {
  EXPECT_EQ(pairs_within(points(Edge::periodic, {}), 0.4), Pairs{});
  EXPECT_EQ(pairs_within(points(Edge::periodic, {{0.5, 0.5}}), 0.4), Pairs{});
}

template <class Grid>
class AnyGrid : public testing::Test {};
using Grids = testing::Types<LinkedGrid, PackedGrid>;
TYPED_TEST_SUITE(AnyGrid, Grids);

TYPED_TEST(AnyGrid, RefusesPointsThatAreNotFinite) {
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 4);
  double const infinity = std::numeric_limits<double>::infinity();
  for (double const bad : {std::nan(""), infinity, -infinity}) {
    std::vector<double> const good_ones{0.1, 0.2, 0.3};
    std::vector<double> const with_bad_one{0.1, 0.2, bad};
    EXPECT_THROW(TypeParam(layout, with_bad_one, good_ones), Error) << bad;
    EXPECT_THROW(TypeParam(layout, good_ones, with_bad_one), Error) << bad;
  }
}

TYPED_TEST(AnyGrid, RefusesListsOfDifferentLengths) {
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 4);
  std::vector<double> const two{0.1, 0.2};
  std::vector<double> const three{0.1, 0.2, 0.3};
  EXPECT_THROW(TypeParam(layout, three, two), Error);
  EXPECT_THROW(TypeParam(layout, two, three), Error);
  TypeParam grid(layout, three, three);
  EXPECT_THROW(grid.move_all(three, two), Error);
  EXPECT_THROW(grid.move_all(two, two), Error) << "the grid holds three";
}

TYPED_TEST(AnyGrid, MovesAllItHoldsAlsoWhereItHasRoomForMore) {
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 4);
  TypeParam grid(layout);
  grid.reserve(100);
  grid.insert(1, {0.1, 0.1});
  grid.move_all(std::vector<double>{0.0, 0.9}, std::vector<double>{0.0, 0.9});
  EXPECT_EQ(grid.cell_of(1), 15);
}

TEST(PackedGrid, RefusesACutoffThatIsNoDistance) {
  State const state = points(Edge::wall, {{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.5}});
  PackedGrid const grid = grid_for_cutoff(state, 0.2);
  for (double const bad : {-1.0, std::nan("")}) {
    EXPECT_THROW(static_cast<void>(layout_for_cutoff(state.box, bad, 3)), Error) << bad;
    EXPECT_THROW(pairs_within(state, bad), Error) << bad;
    EXPECT_THROW(grid.for_each_candidate_pair(bad, [](std::size_t, std::size_t) {}), Error) << bad;
  }
  EXPECT_EQ(pairs_within(state, 0.0), Pairs{});
}

TYPED_TEST(AnyGrid, FindsPairsOfImagesOutsideAPeriodicBox) {
  // All 0.125 from each other, as they stand or as images of one another.
  for (auto const& [a, b] : {std::pair{-0.25, 0.625},
                             {-0.25, 0.875},
                             {1.125, 0.25},
                             {-3.0, 5.125},
                             {1e6, -0.125},
                             {1.0, -0.125},
                             {-0.0625, 0.0625}}) {
    for (bool const is_x : {true, false}) {
      State const state =
          points(Edge::periodic, {is_x ? Vector{a, 0.5} : Vector{0.5, a}, is_x ? Vector{b, 0.5} : Vector{0.5, b}});
      TypeParam const grid = grid_for_cutoff<TypeParam>(state, 0.2);
      Vector const expected = state.box.displacement(position(state.agents, 1), position(state.agents, 0));
      EXPECT_EQ(squared_length(expected), 0.125 * 0.125);
      std::size_t found = 0;
      for_each_pair(state, grid, 0.2, [&](std::size_t, std::size_t, Vector d) {
        EXPECT_EQ(d, expected);
        ++found;
      });
      for_each_neighbour(state, grid, 0.2, std::size_t{1}, [&](std::size_t, Vector d) {
        EXPECT_EQ(d, expected);
        ++found;
      });
      EXPECT_EQ(found, 2U) << a << " and " << b;
    }
  }
}

TYPED_TEST(AnyGrid, FindsEachPairOnceWhereTheBlockOfCellsGoesAroundTheBoxAlongOneSideOnly) {
  // Two cells along one side and eight along the other: to the left and to the right of each cell lies the same one.
  // The points are almost half a side apart, both ways around.
  for (bool const is_x : {true, false}) {
    State state{.box = is_x ? Box(1.0, 4.0, Edge::periodic) : Box(4.0, 1.0, Edge::periodic)};
    for (double const p : {0.1, 0.5999}) state.agents.add(is_x ? p : 2.1, is_x ? 2.1 : p, 0.0, 0.0, 0.01, 1.0, 0, 0);
    CellLayout const layout(state.box, is_x ? 2 : 8, is_x ? 8 : 2);
    TypeParam const grid(layout, state.agents.column<X>(), state.agents.column<Y>());
    std::size_t pairs = 0;
    for_each_pair(state, grid, 0.49995, [&](std::size_t, std::size_t, Vector) { ++pairs; });
    EXPECT_EQ(pairs, 1U) << (is_x ? "along x" : "along y");
  }
}

TYPED_TEST(AnyGrid, FollowsAnAgentOutOfAPeriodicBoxAndBack) {
  State state = points(Edge::periodic, {{0.9, 0.9}, {0.5, 0.5}});
  CellLayout const layout(state.box, 8, 8);
  TypeParam grid(layout, state.agents.column<X>(), state.agents.column<Y>());
  for (double const image : {-3.0, -1.0, 0.0, 1.0, 7.0}) {
    state.agents.column<X>()[0] = 0.55 + image;
    state.agents.column<Y>()[0] = 0.45 - image;
    grid.move(0, position(state.agents, 0));
    EXPECT_TRUE(grid.is_consistent());
    EXPECT_EQ(grid.cell_of(0), layout.cell_of({0.55, 0.45}));
    std::size_t pairs = 0;
    for_each_pair(state, grid, 0.1, [&](std::size_t, std::size_t, Vector) { ++pairs; });
    EXPECT_EQ(pairs, 1U) << image;
  }
}

TYPED_TEST(AnyGrid, FindsAllBetweenWallsForAnyCutoffHoweverFar) {
  State const state = points(Edge::wall, {{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.5}, {-7.0, 1e6}});
  TypeParam const grid(CellLayout(state.box, 5, 4), state.agents.column<X>(), state.agents.column<Y>());
  for (double const cutoff : {1e7, 1e19, 1e200, std::numeric_limits<double>::infinity()}) {
    Pairs pairs;
    for_each_pair(state, grid, cutoff, [&](std::size_t i, std::size_t j, Vector) {
      EXPECT_TRUE(pairs.emplace(i, j).second) << "a pair came twice";
    });
    EXPECT_EQ(pairs, (Pairs{{1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}})) << cutoff;
    std::size_t neighbours = 0;
    for_each_neighbour(state, grid, cutoff, std::size_t{3}, [&](std::size_t, Vector) { ++neighbours; });
    EXPECT_EQ(neighbours, 3U) << cutoff;
  }
}

TYPED_TEST(AnyGrid, FindsHundredsOfNeighboursInOneCell) {
  State state{.box = Box(1.0, 1.0, Edge::periodic)};
  for (int n = 0; n < 300; ++n) state.agents.add(0.5 + 1e-5 * n, 0.5, 0, 0, 1e-6, 1.0, 0, 0);
  TypeParam const grid(CellLayout(state.box, 8, 8), state.agents.column<X>(), state.agents.column<Y>());
  std::set<std::size_t> found;
  for_each_neighbour(state, grid, 0.1, std::size_t{150},
                     [&](std::size_t j, Vector) { EXPECT_TRUE(found.insert(j).second); });
  EXPECT_EQ(found.size(), 299U);
}

TEST(ForEachPair, WorksOnAGridCutMuchFinerThanTheCutoff) {
  State const state = points(Edge::wall, {{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.5}});
  LinkedGrid const fine(CellLayout(state.box, 50, 50), state.agents.column<X>(), state.agents.column<Y>());
  Pairs pairs;
  for_each_pair(state, fine, 0.45, [&](std::size_t i, std::size_t j, Vector) { pairs.emplace(i, j); });
  EXPECT_EQ(pairs, (Pairs{{1, 0}, {2, 1}}));
}

}  // namespace
}  // namespace gridlock
