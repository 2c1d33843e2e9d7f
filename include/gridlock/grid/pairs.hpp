#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>

#include "gridlock/core/state.hpp"
#include "gridlock/grid/linked_grid.hpp"
#include "gridlock/grid/neighbour_grid.hpp"
#include "gridlock/grid/packed_grid.hpp"

namespace gridlock {

/// A grid of all disks of a state, cut so that a 3×3 block holds every neighbour nearer than `cutoff`.
template <NeighbourGrid Grid = PackedGrid>
Grid grid_for_cutoff(State const& state, double cutoff) {
  return {layout_for_cutoff(state.box, cutoff, state.disks.size()), state.disks.column<X>(), state.disks.column<Y>()};
}

/// Whether all points lie in [0, width) × [0, height).
bool are_inside(Box const& box, std::span<double const> x, std::span<double const> y);

/// Calls visit(i, j, separation) once for every pair of disks with |separation| < cutoff, where separation is the
/// minimum-image vector r_j − r_i and i > j are rows of the population.
///
/// Every grid finds the same pairs, each in an order of its own. Coordinates may be any finite numbers, also negative:
/// in a periodic box they stand for the image inside, between walls for themselves.
/// Contract: the grid holds the disks where they are, and in a periodic box cutoff ≤ half the shorter side, or a second
/// image of a disk would be missed.
/// Cost: O(N · disks per 3×3 block).
template <NeighbourGrid Grid, class Visit>
void for_each_pair(State const& state, Grid const& grid, double cutoff, Visit visit) {
  auto const x = state.disks.column<X>();
  auto const y = state.disks.column<Y>();
  double const squared_cutoff = cutoff * cutoff;
  auto const search = [&](auto displacement) {
    grid.for_each_candidate_pair(cutoff, [&, displacement](std::size_t a, std::size_t b) {
      std::size_t const i = std::max(a, b);
      std::size_t const j = std::min(a, b);
      Vector const separation = displacement({x[i], y[i]}, {x[j], y[j]});
      if (squared_length(separation) < squared_cutoff) visit(i, j, separation);
    });
  };
  Box const& box = state.box;
  // Asked once instead of for every pair.
  if (!box.is_periodic() || are_inside(box, x, y)) {
    search([&box](Vector from, Vector to) { return box.displacement_inside(from, to); });
  } else {
    search([&box](Vector from, Vector to) { return box.displacement(from, to); });
  }
}

/// What visit(sum, i, j, separation) makes of `sum` over all pairs of disks with |separation| < cutoff.
///
///     Energy const energy = fold_pairs(state, grid, cutoff, Energy{}, [](Energy& sum, auto i, auto j, Vector r) { … });
///
/// The type of the sum is whatever the caller adds to: a number, a histogram, a list.
/// Contract and cost: those of for_each_pair().
template <NeighbourGrid Grid, class Sum, class Visit>
[[nodiscard]] Sum fold_pairs(State const& state, Grid const& grid, double cutoff, Sum sum, Visit visit) {
  for_each_pair(state, grid, cutoff,
                [&](std::size_t i, std::size_t j, Vector separation) { visit(sum, i, j, separation); });
  return sum;
}

/// Calls visit(j, separation) once for every disk with |separation| < cutoff, where separation is the minimum-image
/// vector from p to the disk; also for a disk at p itself.
///
/// On one grid the order is that of for_each_in_block(): cell by cell from the lower left of the block, and in a cell
/// as inserts, moves and erases have left it. Other grids have other orders.
/// Contract: that of for_each_pair(); p is any finite point, like the coordinates. Cost: O(disks per 3×3 block).
template <NeighbourGrid Grid, class Visit>
void for_each_neighbour(State const& state, Grid const& grid, double cutoff, Vector p, Visit visit) {
  double const squared_cutoff = cutoff * cutoff;
  grid.for_each_candidate(p, cutoff, [&](std::size_t j) {
    Vector const separation = state.box.displacement(p, position(state.disks, j));
    if (squared_length(separation) < squared_cutoff) visit(j, separation);
  });
}

/// The same for the neighbours of disk i, which is none of them.
template <NeighbourGrid Grid, class Visit>
void for_each_neighbour(State const& state, Grid const& grid, double cutoff, std::size_t i, Visit visit) {
  for_each_neighbour(state, grid, cutoff, position(state.disks, i), [&](std::size_t j, Vector separation) {
    if (j != i) visit(j, separation);
  });
}

}  // namespace gridlock
