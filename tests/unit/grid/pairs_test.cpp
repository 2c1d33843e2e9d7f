#include "gridlock/grid/pairs.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace gridlock {
namespace {

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

Pairs pairs_within(State const& state, double reach) {
  Pairs pairs;
  for_each_pair(state, grid_for_reach(state, reach), reach, [&](std::size_t i, std::size_t j, Vector separation) {
    EXPECT_GT(i, j);
    EXPECT_EQ(separation, state.box.displacement(position(state.disks, i), position(state.disks, j)));
    EXPECT_TRUE(pairs.emplace(i, j).second) << "a pair came twice";
  });
  return pairs;
}

State points(Edge edge, std::initializer_list<Vector> where) {
  State state{.box = Box(1.0, 1.0, edge)};
  for (Vector const p : where) state.disks.add(p.x, p.y, 0.0, 0.0, 0.01, 1.0, 0, 0);
  return state;
}

TEST(ForEachPair, FindsPairsAcrossTheEdgeOfAPeriodicBoxOnly) {
  std::initializer_list<Vector> const where{{0.02, 0.02}, {0.98, 0.02}, {0.02, 0.98}, {0.98, 0.98}};
  EXPECT_EQ(pairs_within(points(Edge::wall, where), 0.1), Pairs{});
  EXPECT_EQ(pairs_within(points(Edge::periodic, where), 0.1), (Pairs{{1, 0}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {3, 2}}));
}

TEST(ForEachPair, TheReachItselfIsOutside) {
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

TEST(ForEachPair, WorksOnAGridCutMuchFinerThanTheReach) {
  State const state = points(Edge::wall, {{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.5}});
  LinkedGrid const fine(CellLayout(state.box, 50, 50), state.disks.column<X>(), state.disks.column<Y>());
  Pairs pairs;
  for_each_pair(state, fine, 0.45, [&](std::size_t i, std::size_t j, Vector) { pairs.emplace(i, j); });
  EXPECT_EQ(pairs, (Pairs{{1, 0}, {2, 1}}));
}

}  // namespace
}  // namespace gridlock
