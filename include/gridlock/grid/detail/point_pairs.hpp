#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/grid/detail/neighbour_grid.hpp"

namespace gridlock {

/// The points of a box; point i is at (x[i], y[i]).
struct PointsInBox {
  Box const& box;
  std::span<double const> x;
  std::span<double const> y;

  [[nodiscard]] Vector operator[](std::size_t i) const { return {x[i], y[i]}; }
  void prefetch(std::size_t i) const {
    prefetch_near(&x[i]);
    prefetch_near(&y[i]);
  }
};

/// Returns whether all points lie in [0, width) × [0, height).
bool are_inside(PointsInBox const& points);

/// Calls visit(i, j, separation) once for every pair of points with |separation| < cutoff, where separation is the
/// minimum-image vector r_j − r_i, and i > j.
///
/// Every grid finds the same pairs, but in another order. Coordinates may be any finite numbers: a point outside a
/// periodic box means its image inside. Contract: the grid holds the points at these positions, and in a periodic box
/// cutoff ≤ half the shorter side, since a second image of a point would be missed. Cost: O(N · points per 3×3 block).
template <SearchGrid Grid, class Visit>
void for_each_pair(PointsInBox const& points, Grid const& grid, double cutoff, Visit visit) {
  double const squared_cutoff = cutoff * cutoff;
  auto const search = [&](auto displacement) {
    auto const visit_near = [&, displacement](std::size_t a, std::size_t b) {
      std::size_t const i = std::max(a, b);
      std::size_t const j = std::min(a, b);
      Vector const separation = displacement(points[i], points[j]);
      if (squared_length(separation) < squared_cutoff) visit(i, j, separation);
    };
    auto const expect = [&](std::size_t a, std::size_t b) {
      points.prefetch(a);
      points.prefetch(b);
    };
    grid.for_each_candidate_pair(cutoff, visit_near, expect);
  };
  Box const& box = points.box;
  // are_inside() is tested once here, instead of for every pair.
  if (!box.has_images() || are_inside(points)) {
    search([&box](Vector from, Vector to) { return box.displacement_inside(from, to); });
  } else {
    search([&box](Vector from, Vector to) { return box.displacement(from, to); });
  }
}

/// Calls visit(j, separation) once for every point with |separation| < cutoff, where separation is the minimum-image
/// vector from p to the point; also for a point at p itself.
///
/// The order is that of for_each_in_block(): cell by cell from the lower left of the block, and in a cell by the
/// history of insert(), move() and erase(). Other grids have other orders.
/// Contract: that of for_each_pair(); p is any finite point. Cost: O(points per 3×3 block).
template <SearchGrid Grid, class Visit>
void for_each_neighbour(PointsInBox const& points, Grid const& grid, double cutoff, Vector p, Visit visit) {
  double const squared_cutoff = cutoff * cutoff;
  grid.for_each_candidate(p, cutoff, [&](std::size_t j) {
    Vector const separation = points.box.displacement(p, points[j]);
    if (squared_length(separation) < squared_cutoff) visit(j, separation);
  });
}

}  // namespace gridlock
