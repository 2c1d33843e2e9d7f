#pragma once

#include "gridlock/core/vector.hpp"

namespace gridlock {

/// Returns (cos 6θ, sin 6θ) for the angle θ of a vector that is not zero, without trigonometry.
inline Vector sixth_power_of_direction(Vector r) {
  double const squared = squared_length(r);
  // (x + iy)² / |r|², a unit vector at twice the angle.
  double const c = (r.x - r.y) * (r.x + r.y) / squared;
  double const s = 2.0 * r.x * r.y / squared;
  // The third power of c + is.
  return {c * (c * c - 3.0 * s * s), s * (3.0 * c * c - s * s)};
}

}  // namespace gridlock
