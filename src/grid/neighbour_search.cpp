#include "gridlock/grid/neighbour_search.hpp"

#include <cmath>
#include <string>

#include "core/number_text.hpp"
#include "grid/require.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

PackedGrid grid_of(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y) {
  require_bounded_cutoff(cutoff);
  require_box_for(box, cutoff);
  require_equal_lengths(x, y);
  require_point_count(x.size());
  require_points(x, y);
  return {layout_for_cutoff(box, cutoff, x.size()), x, y};
}

}  // namespace

NeighbourSearch::NeighbourSearch(Box const& box, double cutoff, std::span<double const> x, std::span<double const> y)
    : box_(box), cutoff_(cutoff), x_(x), y_(y), grid_(grid_of(box, cutoff, x, y)) {}

void NeighbourSearch::update(std::span<double const> x, std::span<double const> y) {
  require_points(x, y);
  if (x.size() != size()) {
    throw Error({.what = "there are coordinates for " + std::to_string(x.size()) + " points, but the search has " +
                         std::to_string(size()),
                 .hint = "give as many as before, or make a new search"});
  }
  grid_.move_all(x, y);
  x_ = x;
  y_ = y;
}

void NeighbourSearch::require_point(std::size_t i) const {
  if (i < size()) return;
  throw Error({.what = "there is no point " + std::to_string(i) + " among " + std::to_string(size()),
               .hint = "points count from 0"});
}

void NeighbourSearch::require_finite(Vector p) {
  if (std::isfinite(p.x) && std::isfinite(p.y)) return;
  throw Error({.what = "the neighbours of (" + number_text(p.x) + ", " + number_text(p.y) + ") are asked for",
               .hint = "every coordinate must be finite"});
}

bool are_inside(PointsInBox const& points) {
  auto const are_in_range = [](std::span<double const> coordinates, double side) {
    // All are looked at, many at once: as a rule none is outside.
    std::size_t outside = 0;
    for (double const p : coordinates) outside += static_cast<std::size_t>(!((p >= 0.0) & (p < side)));
    return outside == 0;
  };
  return are_in_range(points.x, points.box.width()) && are_in_range(points.y, points.box.height());
}

}  // namespace gridlock
