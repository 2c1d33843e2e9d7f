#include "grid/require.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/magnitude.hpp"
#include "core/number_text.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// Returns whether all coordinates are finite, without a branch: x − x is 0 for finite numbers only.
bool are_finite(std::span<double const> coordinates) {
  std::size_t broken = 0;
  for (double const p : coordinates) broken += static_cast<std::size_t>(!(p - p == 0.0));
  return broken == 0;
}

}  // namespace

void require_cutoff(double cutoff) {
  if (cutoff >= 0.0) return;
  throw Error(
      {.what = "the cutoff of a neighbour search is " + number_text(cutoff), .hint = "use a distance of 0 or above"});
}

void require_equal_lengths(std::span<double const> x, std::span<double const> y) {
  if (x.size() == y.size()) return;
  throw Error({.what = "there are " + std::to_string(x.size()) + " x coordinates and " + std::to_string(y.size()) +
                       " y coordinates",
               .hint = "give every point one of each"});
}

void require_points(std::span<double const> x, std::span<double const> y) {
  require_equal_lengths(x, y);
  if (are_finite(x) && are_finite(y)) return;
  for (std::size_t i = 0; i < x.size(); ++i) require_finite_point(i, {x[i], y[i]});
}

void require_finite_point(std::size_t i, Vector p) {
  if (std::isfinite(p.x) && std::isfinite(p.y)) return;
  throw Error({.what = "point " + std::to_string(i) + " is at (" + number_text(p.x) + ", " + number_text(p.y) + ")",
               .hint = "every coordinate must be finite"});
}

void require_bounded_cutoff(double cutoff) {
  if (has_bounded_magnitude(cutoff)) return;
  throw Error({.what = "the cutoff of a neighbour search is " + number_text(cutoff),
               .hint = "use a distance from 1e-60 to 1e60"});
}

void require_box_for(Box const& box, double cutoff) {
  if (auto problem = find_extreme_sides(box)) throw Error(*problem);
  double const most = 0.5 * box.shortest_period();
  if (cutoff <= most) return;
  throw Error({.what = "a cutoff of " + number_text(cutoff) + " is more than half a side of the periodic box of " +
                       number_text(box.width()) + " × " + number_text(box.height()),
               .hint = "use at most " + number_text(most) +
                       ", or a larger box: beyond that two images of a point are neighbours"});
}

void require_point_count(std::size_t points) {
  // The number of points that a packed grid holds in a box of any shape.
  constexpr std::size_t max_points = 250'000'000;
  if (points <= max_points) return;
  throw Error({.what = "a neighbour search among " + std::to_string(points) + " points cannot be made",
               .hint = "use at most " + std::to_string(max_points)});
}

void require_points_in_memory(PointsInMemory const& points) {
  require_point_count(points.count);
  for (std::size_t i = 0; i < points.count; ++i) {
    double const x = points.x[i * points.stride];
    double const y = points.y[i * points.stride];
    if (!(x - x == 0.0) | !(y - y == 0.0)) require_finite_point(i, {x, y});
  }
}

void require_search(PointsInMemory const& points, double cutoff) {
  require_bounded_cutoff(cutoff);
  require_points_in_memory(points);
}

void require_radii(std::span<double const> radius, std::size_t count) {
  if (radius.size() != count) {
    throw Error({.what = std::to_string(radius.size()) + " radii of " + std::to_string(count) + " disks",
                 .hint = "give one of each for every disk"});
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (has_bounded_magnitude(radius[i])) continue;
    throw Error({.what = "disk " + std::to_string(i) + " has radius " + number_text(radius[i]),
                 .hint = "use radii from 1e-60 to 1e60"});
  }
}

void require_reach(DiskReach const& reach) {
  bool const is_reach =
      std::isfinite(reach.factor) && reach.factor > 0.0 && std::isfinite(reach.gap) && reach.gap >= 0.0;
  if (is_reach) return;
  throw Error({.what = "a reach of " + number_text(reach.factor) + " times the distance at contact and " +
                       number_text(reach.gap),
               .hint = "use a factor above 0 and a gap of at least 0"});
}

void require_all_moved(std::size_t moved, std::size_t held, std::size_t coordinates) {
  if (moved == held) return;
  throw Error({.what = "there are coordinates for " + std::to_string(coordinates) + " agents, but " +
                       std::to_string(held - moved) + " agents of the grid are beyond them",
               .hint = "give coordinates for every agent that the grid holds"});
}

}  // namespace gridlock
