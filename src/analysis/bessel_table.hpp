#pragma once

#include <math.h>  // POSIX declares j0 and j1 here; <cmath> need not

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gridlock {

/// A table of J₀(√s), the mean of cos(q·r) over all directions for s = q²r², with an error below 10⁻⁹.
///
/// As a function of s it is smooth at 0 and needs no square root. The table has cubic Hermite polynomials between
/// values of the C library.
/// Error of the polynomials: h⁴/384 · max |f⁗| = 10⁻¹⁰ for h = 1/8. Beyond the table j0() of the C library is called.
class BesselTable {
 public:
  BesselTable() : pieces_(size) {
    for (std::size_t k = 0; k < size; ++k) {
      double const from = static_cast<double>(k) * width;
      double const f0 = value(from);
      double const f1 = value(from + width);
      double const d0 = width * slope(from);
      double const d1 = width * slope(from + width);
      pieces_[k] = {f0, d0, 3.0 * (f1 - f0) - 2.0 * d0 - d1, 2.0 * (f0 - f1) + d0 + d1};
    }
  }

  double operator()(double s) const {
    if (!(s < end)) return value(s);
    double const scaled = s * (1.0 / width);
    auto const k = static_cast<std::int32_t>(scaled);  // processors convert to a signed integer in one instruction
    double const t = scaled - static_cast<double>(k);
    auto const& [a, b, c, d] = pieces_[static_cast<std::size_t>(k)];
    return a + t * (b + t * (c + t * d));
  }

  /// The four coefficients of each polynomial, one polynomial after the other.
  [[nodiscard]] double const* pieces() const { return pieces_.front().data(); }

  static constexpr std::size_t size = 4096;
  static constexpr double width = 0.125;
  static constexpr double end = static_cast<double>(size) * width;

 private:
  static double value(double s) { return ::j0(::sqrt(s)); }
  static double slope(double s) { return s == 0.0 ? -0.25 : -::j1(::sqrt(s)) / (2.0 * ::sqrt(s)); }

  std::vector<std::array<double, 4>> pieces_;
};

}  // namespace gridlock
