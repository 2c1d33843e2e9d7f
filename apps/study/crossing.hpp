#pragma once

#include <span>
#include <string>
#include <vector>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// One point of a curve: y with its standard error at an exact x.
struct CurvePoint {
  double x = 0.0;
  Estimate y;
};

/// Whether and where a curve falls through a level.
enum class CrossingKind {
  crossed,
  stays_above,   ///< no point lies below the level
  starts_below,  ///< the first point lies below it already
  no_points,
};

/// The first interval in which a curve falls from at or above the level to below it.
struct Crossing {
  CrossingKind kind = CrossingKind::no_points;
  double last_above = 0.0;  ///< x of the two points around it; for crossed alone
  double first_below = 0.0;
  double x = 0.0;              ///< where the straight line between them in (x, ln y) meets the level
  double statistical = 0.0;    ///< standard error of x from the errors of the two points; 0 where they have none
  double interpolation = 0.0;  ///< how far a straight line in (x, y) would put it elsewhere
  bool comes_back = false;     ///< a later point lies more than two standard errors above the level again

  /// Both errors together.
  [[nodiscard]] double error() const;
};

/// Looks along points in rising x.
///
///     x = x_1 + (x_2 − x_1) s,   s = ln(y_1/level) / ln(y_1/y_2)
///
/// The displacement of dense disks falls by a factor rather than a difference from one density to the next, hence the
/// logarithm. Contract: level > 0, x rising, y > 0 (asserted).
Crossing find_crossing(std::span<CurvePoint const> points, double level);

}  // namespace gridlock
