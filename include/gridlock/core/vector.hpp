#pragma once

#include <cstdint>
#include <limits>

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

namespace detail {

/// Returns cosine and sine by Taylor series to x¹⁶ and x¹⁷ for |x| ≤ π/4; the first terms left out are below 1e-18.
constexpr Vector direction_near_zero(double x) {
  // The two series are computed together, since each step of a series waits for the step before.
  double const s = x * x;
  Vector sum{1.0 / 20922789888000.0, 1.0 / 355687428096000.0};
  auto const add = [&](double even, double odd) { sum = Vector{sum.x * s + even, sum.y * s + odd}; };
  add(-1.0 / 87178291200.0, -1.0 / 1307674368000.0);
  add(1.0 / 479001600.0, 1.0 / 6227020800.0);
  add(-1.0 / 3628800.0, -1.0 / 39916800.0);
  add(1.0 / 40320.0, 1.0 / 362880.0);
  add(-1.0 / 720.0, -1.0 / 5040.0);
  add(1.0 / 24.0, 1.0 / 120.0);
  add(-0.5, -1.0 / 6.0);
  return {1.0 + s * sum.x, x + x * s * sum.y};
}

/// Returns (c, s) turned by this number of right angles.
template <class Pair, class Number>
constexpr Pair turned_by_quarters(Number c, Number s, std::uint64_t quarters) {
  switch (quarters & 3U) {
    case 0:
      return {c, s};
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    default:
      return {s, -c};
  }
}

}  // namespace detail

/// Returns (cos φ, sin φ) for an angle φ in radians, to about 1e-16 for |φ| ≤ 100.
///
/// Only additions and multiplications are used, so that every compiler gives the same bits; std::sin does not, and must
/// not be used for values that enter a state. NaN and infinities give NaN.
///
/// ```cpp
/// Vector const heading = direction(0.5);
/// Vector const turned = rotated(heading, direction(0.1));  // direction(0.6), but for rounding
/// ```
constexpr Vector direction(double angle) {
  constexpr double quarters_per_radian = 0.63661977236758134308;  // 2/π
  // π/2 is the sum of two parts; the first has so few bits that its multiples are exact.
  constexpr double quarter_high = 1.57079632673412561417;
  constexpr double quarter_low = 6.07710050650619224932e-11;
  // The nearest whole number: a sum with this number has no bits for a fraction.
  constexpr double large = 0x1.8p52;
  double const quarters = (angle * quarters_per_radian + large) - large;
  if (!(quarters < 1e9 && quarters > -1e9)) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  double const rest = (angle - quarters * quarter_high) - quarters * quarter_low;
  auto const [c, s] = detail::direction_near_zero(rest);
  return detail::turned_by_quarters<Vector>(c, s, static_cast<std::uint64_t>(static_cast<std::int64_t>(quarters)));
}

/// Returns `v` rotated by the angle φ, where `turn` is direction(φ): the product of two complex numbers.
constexpr Vector rotated(Vector v, Vector turn) { return {v.x * turn.x - v.y * turn.y, v.x * turn.y + v.y * turn.x}; }

}  // namespace gridlock
