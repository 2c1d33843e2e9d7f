#pragma once

namespace gridlock {

/// A point or displacement in the plane, in the length unit of the box.
///
/// ```cpp
/// Vector const a{1.0, 2.0};
/// Vector const b = 2.0 * a - Vector{0.5, 0.0};  // (1.5, 4)
/// double const squared_distance = squared_length(b - a);
/// ```
struct Vector {
  double x = 0.0;
  double y = 0.0;

  friend constexpr Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vector operator*(double s, Vector a) { return {s * a.x, s * a.y}; }
  friend constexpr bool operator==(Vector const&, Vector const&) = default;
};

/// Returns the scalar product a·b.
constexpr double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }

/// Returns the squared length a·a, which costs no square root: enough to compare lengths.
constexpr double squared_length(Vector a) { return dot(a, a); }

/// Returns (cos φ, sin φ) for an angle φ in radians, to about 1e-16 for |φ| ≤ 100.
///
/// Only additions and multiplications are used, so that every compiler gives the same bits; std::sin does not, and must
/// not be used for values that enter a state. NaN and infinities give NaN.
///
/// ```cpp
/// Vector const heading = direction(0.5);
/// Vector const turned = rotated(heading, direction(0.1));  // direction(0.6), but for rounding
/// ```
Vector direction(double angle);

/// Returns `v` rotated by the angle φ, where `turn` is direction(φ): the product of two complex numbers.
constexpr Vector rotated(Vector v, Vector turn) { return {v.x * turn.x - v.y * turn.y, v.x * turn.y + v.y * turn.x}; }

}  // namespace gridlock
