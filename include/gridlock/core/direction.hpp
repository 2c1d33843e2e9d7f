#pragma once

#include "gridlock/core/vector.hpp"

namespace gridlock {

/// (cos φ, sin φ) for an angle φ in radians, to about 1e-16 for |φ| ≤ 100.
///
/// Made of additions and multiplications alone, so that every compiler and mathematical library gives the same bits:
/// what feeds back into a state must not come from std::sin. NaN and infinities give NaN.
///
/// ```cpp
/// Vector const heading = direction(0.5);
/// Vector const turned = rotated(heading, direction(0.1));  // direction(0.6), but for rounding
/// ```
Vector direction(double angle);

/// `v` turned by the angle whose direction() is `turn`: the product of two complex numbers.
constexpr Vector rotated(Vector v, Vector turn) { return {v.x * turn.x - v.y * turn.y, v.x * turn.y + v.y * turn.x}; }

}  // namespace gridlock
