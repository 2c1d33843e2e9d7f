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

/// Scalar product a·b.
constexpr double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y; }

/// Squared length a·a; preferred over the length wherever a comparison is enough, since it needs no square root.
constexpr double squared_length(Vector a) { return dot(a, a); }

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
