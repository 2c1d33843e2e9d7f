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

}  // namespace gridlock
