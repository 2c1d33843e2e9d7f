#pragma once

#include <cstddef>

#include "gridlock/core/state.hpp"
#include "gridlock/grid/linked_grid.hpp"

namespace gridlock {

/// The lists of all disks of a state, cut so that a 3×3 block holds every neighbour nearer than `reach`.
LinkedGrid grid_for_reach(State const& state, double reach);

/// Calls visit(i, j, separation) once for every pair of disks with |separation| < reach, where separation is the
/// minimum-image vector r_j − r_i and i > j are rows of the population.
///
/// Contract: in a periodic box reach ≤ half the shorter side, or a second image of a disk would be missed.
/// Cost: O(N · disks per 3×3 block).
template <class Visit>
void for_each_pair(State const& state, LinkedGrid const& grid, double reach, Visit visit) {
  CellLayout const& layout = grid.layout();
  int const reach_columns = layout.columns_within(reach);
  int const reach_rows = layout.rows_within(reach);
  for (std::size_t i = 0; i < state.disks.size(); ++i) {
    Vector const here = position(state.disks, i);
    grid.for_each_in_block(grid.cell_of(i), reach_columns, reach_rows, [&](std::size_t j) {
      if (j >= i) return;
      Vector const separation = state.box.displacement(here, position(state.disks, j));
      if (squared_length(separation) < reach * reach) visit(i, j, separation);
    });
  }
}

}  // namespace gridlock
