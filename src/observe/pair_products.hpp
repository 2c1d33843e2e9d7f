#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>

namespace gridlock {

/// The last bits of its sum with a double below 2⁵¹ are the whole number next to the double.
inline constexpr double whole_number_shift = 0x1.8p52;

/// Returns the whole number next to Re a* b · units, for a product of magnitude below 2⁵¹.
inline std::int64_t product_in_units(std::complex<double> a, std::complex<double> b, double units) {
  double const product = units * a.real() * b.real() + units * a.imag() * b.imag();
  return std::bit_cast<std::int64_t>(product + whole_number_shift) - std::bit_cast<std::int64_t>(whole_number_shift);
}

/// Returns the number of units in 1 of a product ψ_i* ψ_j with |ψ|² ≤ `largest`, a power of two. A unit is at most N² ·
/// 2⁻⁵⁹ of the largest product, and a sum over all ordered pairs of so many points does not overflow.
inline double units_of_products(double largest, std::size_t points) {
  if (!(largest > 0.0)) return 1.0;
  int const bits = std::min(50, 62 - 2 * static_cast<int>(std::bit_width(points)));
  return std::ldexp(1.0, bits - std::ilogb(largest) - 1);
}

}  // namespace gridlock
