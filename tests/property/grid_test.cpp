#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "grid/linked_grid.hpp"
#include "grid/pairs.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {
namespace {

double between(double low, double high) { return low + (high - low) * (*rc::gen::inRange(0, 10001) / 10000.0); }

Box any_box() {
  auto const edge = rc::gen::element(Edge::wall, Edge::periodic);
  return {between(0.2, 3.0), between(0.2, 3.0), *edge, *edge};
}

std::uint64_t any_cells() { return static_cast<std::uint64_t>(*rc::gen::inRange(1, 8)); }

/// Points anywhere in the box, many of them on its edges and on the borders of cells; of a periodic box often images
/// outside.
State any_points(Box const& box) {
  State state{.box = box};
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  int const count = *rc::gen::inRange(0, 60);
  bool const are_inside = *rc::gen::arbitrary<bool>();
  auto const coordinate = [&](double side, bool is_periodic) {
    double const twelfths = static_cast<double>(random.below(13)) / 12.0 * side;
    double const p = random.below(3) == 0 ? twelfths : random.uniform() * side;
    if (!is_periodic) return p;
    return are_inside ? (p >= side ? 0.0 : p) : p + (0.5 * static_cast<double>(random.below(9)) - 2.5) * side;
  };
  for (int n = 0; n < count; ++n) {
    double const x = coordinate(box.width(), box.is_periodic_x());
    double const y = coordinate(box.height(), box.is_periodic_y());
    state.agents.add(x, y, 0.0, 0.0, 0.02 + 0.1 * random.uniform(), 1.0, 0, 0);
  }
  return state;
}

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

Pairs pairs_by_brute_force(State const& state, double cutoff) {
  Pairs pairs;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Vector const d = state.box.displacement(position(state.agents, i), position(state.agents, j));
      if (squared_length(d) < cutoff * cutoff) pairs.emplace(i, j);
    }
  }
  return pairs;
}

Pairs pairs_by_grid(State const& state, LinkedGrid const& grid, double cutoff) {
  Pairs pairs;
  for_each_pair(state, grid, cutoff, [&](std::size_t i, std::size_t j, Vector separation) {
    RC_ASSERT(i > j);
    RC_ASSERT(separation == state.box.displacement(position(state.agents, i), position(state.agents, j)));
    RC_ASSERT(pairs.emplace(i, j).second);
  });
  return pairs;
}

RC_GTEST_PROP(GridProperty, ForEachPairFindsThePairsOfBruteForceOnTheGridMadeForTheCutoff, ()) {
  State const state = any_points(any_box());
  double const cutoff = between(0.001, 0.5) * std::min(state.box.width(), state.box.height());
  LinkedGrid const grid = grid_for_cutoff<LinkedGrid>(state, cutoff);
  RC_CLASSIFY(grid.layout().count() == 1);
  RC_CLASSIFY(grid.layout().columns() <= 3 || grid.layout().rows() <= 3);
  RC_ASSERT(grid.is_consistent());
  RC_ASSERT(pairs_by_grid(state, grid, cutoff) == pairs_by_brute_force(state, cutoff));
}

RC_GTEST_PROP(GridProperty, ForEachPairFindsThePairsOfBruteForceOnAnyGrid, ()) {
  State const state = any_points(any_box());
  double const cutoff = between(0.001, 0.5) * std::min(state.box.width(), state.box.height());
  CellLayout const layout(state.box, any_cells(), any_cells());
  LinkedGrid const grid(layout, state.agents.column<X>(), state.agents.column<Y>());
  RC_ASSERT(pairs_by_grid(state, grid, cutoff) == pairs_by_brute_force(state, cutoff));
}

RC_GTEST_PROP(GridProperty, LargestOverlapIsThatOfBruteForce, ()) {
  State const state = any_points(any_box());
  double largest = 0.0;
  for (auto const& [i, j] : pairs_by_brute_force(state, 10.0)) {
    double const distance =
        std::sqrt(squared_length(state.box.displacement(position(state.agents, i), position(state.agents, j))));
    largest = std::max(largest, state.agents.column<Radius>()[i] + state.agents.column<Radius>()[j] - distance);
  }
  RC_ASSERT(std::abs(largest_overlap(state) - largest) < 1e-15);
}

RC_GTEST_PROP(GridProperty, TheListsStayConsistentUnderAnySequenceOfInsertsMovesAndErases, ()) {
  Box const box = any_box();
  LinkedGrid grid(CellLayout(box, any_cells(), any_cells()));
  std::map<std::size_t, int> model;  // agent → cell
  RandomStream random(*rc::gen::arbitrary<std::uint64_t>(), 0, 0, Purpose::start_position);
  int const operations = *rc::gen::inRange(0, 200);
  for (int n = 0; n < operations; ++n) {
    auto const agent = static_cast<std::size_t>(random.below(20));
    // Also points outside the box, which belong to the nearest cell.
    Vector const p{(1.4 * random.uniform() - 0.2) * box.width(), (1.4 * random.uniform() - 0.2) * box.height()};
    bool const is_in = model.contains(agent);
    if (!is_in) {
      grid.insert(agent, p);
    } else if (random.below(3) > 0) {
      grid.move(agent, p);
    } else {
      grid.erase(agent);
      model.erase(agent);
    }
    if (grid.contains(agent)) model[agent] = grid.layout().cell_of(p);
    RC_ASSERT(grid.is_consistent());
    RC_ASSERT(grid.size() == model.size());
  }
  std::map<std::size_t, int> listed;
  for (int cell = 0; cell < grid.layout().count(); ++cell) {
    grid.for_each_in_cell(cell, [&](std::size_t agent) { RC_ASSERT(listed.emplace(agent, cell).second); });
  }
  RC_ASSERT(listed == model);
  for (auto const& [agent, cell] : model) RC_ASSERT(grid.cell_of(agent) == cell);
}

}  // namespace
}  // namespace gridlock
