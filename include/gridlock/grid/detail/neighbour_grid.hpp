#pragma once

#include <concepts>
#include <cstddef>
#include <span>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// A grid for searches has these functions:
///
/// - for_each_candidate(p, cutoff, visit): calls visit(j) once for every agent nearer to p than `cutoff`, and for some
///   farther agents: the caller measures the exact distance.
/// - for_each_candidate_pair(cutoff, visit, expect): calls visit(i, j) once for every pair nearer than `cutoff`, in
///   either order, and for some farther pairs; it may call expect(i, j) some time before, to prefetch memory.
template <class Grid>
concept SearchGrid = requires(Grid const same, Vector p, double cutoff, void (*visit)(std::size_t),
                              void (*visit_pair)(std::size_t, std::size_t)) {
  same.for_each_candidate(p, cutoff, visit);
  same.for_each_candidate_pair(cutoff, visit_pair);
  same.for_each_candidate_pair(cutoff, visit_pair, visit_pair);
};

/// A grid that follows moving agents has these functions. Agents are numbered by their rows. LinkedGrid keeps the
/// linked lists of the paper, PackedGrid keeps the agents of a cell side by side in memory.
///
/// - insert, erase, move: add, remove or move one agent, in O(1). A grid may copy the point, so the caller
///   must call move() after every motion, also within a cell.
/// - reserve(agents): allocates memory for agents 0 … agents − 1, so that insert() allocates none.
/// - move_all(x, y): moves every agent i of the grid to (x[i], y[i]).
/// - for_each_in_cell, for_each_in_block: call visit(agent) for the agents of a cell, or of a block of cells around it.
///
/// Points may be any finite points: a point outside a periodic box means its image inside, a point outside walls stays
/// outside.
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
