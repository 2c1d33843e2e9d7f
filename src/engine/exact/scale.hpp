#pragma once

#include <cmath>

namespace gridlock::exact {

/// The largest power of two not above a positive number: epochs are that long, so that event times are reduced exactly.
inline double power_of_two_below(double value) {
  int exponent = 0;
  static_cast<void>(std::frexp(value, &exponent));
  return std::ldexp(1.0, exponent - 1);
}

/// The factor of all radii while disks grow: at_zero + rest + rate · t at time t of the epoch.
///
/// The rest is what is too small for the digits of at_zero: close to jamming the disks grow by a last digit or two from
/// one collision to the next.
struct Scale {
  double at_zero = 1.0;
  double rest = 0.0;
  double rate = 0.0;

  [[nodiscard]] double at(double time) const { return at_zero + (rest + rate * time); }
  [[nodiscard]] double time_of(double scale) const { return ((scale - at_zero) - rest) / rate; }

  /// Counts times from `time` on.
  void move_zero(double time) {
    double const growth = rest + rate * time;
    double const moved = at_zero + growth;
    rest = growth - (moved - at_zero);  // exact, for |growth| is not above |at_zero|
    at_zero = moved;
  }
};

}  // namespace gridlock::exact
