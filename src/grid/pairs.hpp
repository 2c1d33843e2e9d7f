#pragma once

#include <cstddef>
#include <utility>

#include "grid/linked_grid.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/point_pairs.hpp"

namespace gridlock {

// Pairs and neighbours of disks, on any grid.

inline PointsInBox centres(State const& state) {
  return {state.box, state.agents.column<X>(), state.agents.column<Y>()};
}

/// Makes a grid of all disks of a state, such that a 3×3 block holds every neighbour nearer than `cutoff`.
template <NeighbourGrid Grid = PackedGrid>
Grid grid_for_cutoff(State const& state, double cutoff) {
  return {layout_for_cutoff(state.box, cutoff, state.agents.size()), state.agents.column<X>(),
          state.agents.column<Y>()};
}

/// Calls visit as for_each_pair(PointsInBox, …); i > j are rows of the population.
template <SearchGrid Grid, class Visit>
void for_each_pair(State const& state, Grid const& grid, double cutoff, Visit visit) {
  for_each_pair(centres(state), grid, cutoff, std::move(visit));
}

/// Calls visit as for_each_neighbour(PointsInBox, …).
template <SearchGrid Grid, class Visit>
void for_each_neighbour(State const& state, Grid const& grid, double cutoff, Vector p, Visit visit) {
  for_each_neighbour(centres(state), grid, cutoff, p, std::move(visit));
}

/// Calls visit for the neighbours of disk i, without the disk itself.
template <SearchGrid Grid, class Visit>
void for_each_neighbour(State const& state, Grid const& grid, double cutoff, std::size_t i, Visit visit) {
  for_each_neighbour(state, grid, cutoff, position(state.agents, i), [&](std::size_t j, Vector separation) {
    if (j != i) visit(j, separation);
  });
}

}  // namespace gridlock
