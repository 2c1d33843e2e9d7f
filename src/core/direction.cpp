#include "gridlock/core/direction.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace gridlock {

namespace {

/// Taylor's series to x¹⁷ and x¹⁶ on |x| ≤ π/4, where the first term left out is below 1e-18.
double sine_near_zero(double x) {
  double const s = x * x;
  double sum = 1.0 / 355687428096000.0;
  sum = sum * s - 1.0 / 1307674368000.0;
  sum = sum * s + 1.0 / 6227020800.0;
  sum = sum * s - 1.0 / 39916800.0;
  sum = sum * s + 1.0 / 362880.0;
  sum = sum * s - 1.0 / 5040.0;
  sum = sum * s + 1.0 / 120.0;
  sum = sum * s - 1.0 / 6.0;
  return x + x * s * sum;
}

double cosine_near_zero(double x) {
  double const s = x * x;
  double sum = 1.0 / 20922789888000.0;
  sum = sum * s - 1.0 / 87178291200.0;
  sum = sum * s + 1.0 / 479001600.0;
  sum = sum * s - 1.0 / 3628800.0;
  sum = sum * s + 1.0 / 40320.0;
  sum = sum * s - 1.0 / 720.0;
  sum = sum * s + 1.0 / 24.0;
  sum = sum * s - 0.5;
  return 1.0 + s * sum;
}

}  // namespace

Vector direction(double angle) {
  constexpr double quarters_per_radian = 0.63661977236758134308;  // 2/π
  // π/2 in two parts, the first with so few bits that its multiples are exact.
  constexpr double quarter_high = 1.57079632673412561417;
  constexpr double quarter_low = 6.07710050650619224932e-11;
  double const quarters = std::floor(angle * quarters_per_radian + 0.5);
  if (!(std::abs(quarters) < 1e9)) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
  double const rest = (angle - quarters * quarter_high) - quarters * quarter_low;
  double const c = cosine_near_zero(rest);
  double const s = sine_near_zero(rest);
  switch (static_cast<std::int64_t>(quarters) & 3) {
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

}  // namespace gridlock
