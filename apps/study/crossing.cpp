#include "study/crossing.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace gridlock {

namespace {

/// Where between two points around the level, with the errors of that place.
void interpolate(CurvePoint const& above, CurvePoint const& below, double level, Crossing& crossing) {
  double const y1 = above.y.value;
  double const y2 = below.y.value;
  double const width = below.x - above.x;
  double const fall = std::log(y1 / y2);
  double const share = std::log(y1 / level) / fall;
  crossing.x = above.x + width * share;
  // ∂s/∂ln y1 = (1 − s)/fall and ∂s/∂ln y2 = s/fall.
  double const relative_1 = above.y.error.value_or(0.0) / y1;
  double const relative_2 = below.y.error.value_or(0.0) / y2;
  crossing.statistical = width / fall * std::hypot((1.0 - share) * relative_1, share * relative_2);
  double const straight = above.x + width * (y1 - level) / (y1 - y2);
  crossing.interpolation = std::abs(straight - crossing.x);
}

}  // namespace

double Crossing::error() const { return std::hypot(statistical, interpolation); }

Crossing find_crossing(std::span<CurvePoint const> points, double level) {
  assert(level > 0.0);
  assert(std::ranges::is_sorted(points, {}, &CurvePoint::x));
  Crossing crossing;
  if (points.empty()) return crossing;
  auto const is_below = [&](CurvePoint const& point) { return point.y.value < level; };
  auto const below = std::ranges::find_if(points, is_below);
  if (below == points.end()) {
    crossing.kind = CrossingKind::stays_above;
    return crossing;
  }
  if (below == points.begin()) {
    crossing.kind = CrossingKind::starts_below;
    return crossing;
  }
  assert(below->y.value > 0.0);
  auto const above = below - 1;
  crossing.kind = CrossingKind::crossed;
  crossing.last_above = above->x;
  crossing.first_below = below->x;
  interpolate(*above, *below, level, crossing);
  crossing.comes_back = std::any_of(below + 1, points.end(), [&](CurvePoint const& point) {
    return point.y.value > level + 2.0 * point.y.error.value_or(0.0);
  });
  return crossing;
}

}  // namespace gridlock
