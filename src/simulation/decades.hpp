#pragma once

#include <cmath>
#include <cstdint>

namespace gridlock {

/// Returns ⌊10^(k/p) + ½⌋, the number k = 0, 1, 2 … of p whole numbers in each factor of ten, evenly in the logarithm;
/// the same number may come several times at first.
inline double whole_number_in_decades(double k, std::uint64_t per_decade) {
  return std::floor(std::pow(10.0, k * (1.0 / static_cast<double>(per_decade))) + 0.5);
}

}  // namespace gridlock
