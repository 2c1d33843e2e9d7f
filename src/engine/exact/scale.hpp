#pragma once

#include <cmath>

namespace gridlock::exact {

/// Returns the largest power of two not above a positive number: the length of an epoch, which no rounding reduces.
inline double power_of_two_below(double value) {
  int exponent = 0;
  static_cast<void>(std::frexp(value, &exponent));
  return std::ldexp(1.0, exponent - 1);
}

/// The factor of all radii while disks grow: at_zero + rest + rate · t at time t of the epoch.
///
/// `rest` holds what is too small for the digits of at_zero: close to jamming, radii grow by one or two last digits
/// between collisions.
struct Scale {
  double at_zero = 1.0;
  double rest = 0.0;
  double rate = 0.0;

  [[nodiscard]] double at(double time) const { return at_zero + (rest + rate * time); }
  [[nodiscard]] double time_of(double scale) const { return ((scale - at_zero) - rest) / rate; }

  /// Moves the zero of time to `time`.
  void move_zero(double time) {
    double const growth = rest + rate * time;
    double const moved = at_zero + growth;
    rest = growth - (moved - at_zero);  // exact, because |growth| is not above |at_zero|
    at_zero = moved;
  }
};

}  // namespace gridlock::exact
