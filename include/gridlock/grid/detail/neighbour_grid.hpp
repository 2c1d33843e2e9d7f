#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// A search needs these functions of a grid:
///
/// - for_each_candidate(p, cutoff, visit): calls visit(j) once for every agent nearer to p than `cutoff`, and for some
///   that are farther: the caller measures the distance that counts.
/// - for_each_candidate_pair(cutoff, visit, expect): calls visit(i, j) once for every pair nearer than `cutoff`, either one first,
///   and for some that are farther; it may call expect(i, j) some time before, to ask for memory.
template <class Grid>
concept SearchGrid = requires(Grid const same, Vector p, double cutoff, void (*visit)(std::size_t),
                              void (*visit_pair)(std::size_t, std::size_t)) {
  same.for_each_candidate(p, cutoff, visit);
  same.for_each_candidate_pair(cutoff, visit_pair);
  same.for_each_candidate_pair(cutoff, visit_pair, visit_pair);
};

/// A grid must know this of the agents it holds, named by their row in the population, so that every search works on
/// any grid: LinkedGrid keeps the paper's lists, PackedGrid keeps the agents of a cell side by side in memory.
///
/// - insert, erase, move: O(1), one agent appears, disappears, is somewhere else. A grid may copy the point, so move()
///   follows every motion, also one within a cell.
/// - reserve(agents): makes room for agents 0 … agents − 1, so that inserting them costs no more than that.
/// - move_all(x, y): agent i of all that are held is at (x[i], y[i]).
/// - for_each_in_cell, for_each_in_block: the agents of one cell, or of a block of cells around it.
///
/// Points may be any finite ones: outside a periodic box they stand for their image inside, outside walls for
/// themselves.
template <class Grid>
concept NeighbourGrid = SearchGrid<Grid> && requires(Grid grid, Grid const same, std::size_t agent, Vector p, int cell,
                                                     std::span<double const> x, void (*visit)(std::size_t)) {
  requires std::constructible_from<Grid, CellLayout const&>;
  requires std::constructible_from<Grid, CellLayout const&, std::span<double const>, std::span<double const>>;
  { same.layout() } -> std::same_as<CellLayout const&>;
  { same.size() } -> std::same_as<std::size_t>;
  { same.contains(agent) } -> std::same_as<bool>;
  { same.cell_of(agent) } -> std::same_as<int>;
  { same.is_consistent() } -> std::same_as<bool>;
  grid.reserve(agent);
  grid.insert(agent, p);
  grid.erase(agent);
  grid.move(agent, p);
  grid.move_all(x, x);
  same.for_each_in_cell(cell, visit);
  same.for_each_in_block(cell, cell, cell, visit);
};

}  // namespace gridlock
