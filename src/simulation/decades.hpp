#pragma once

#include <cmath>

namespace gridlock {

/// Returns ⌊10^exponent + ½⌋, for whole numbers that are even in the logarithm: exponents k/p, k = 0, 1, 2 …, give p of
/// them in each factor of ten.
inline double rounded_power_of_ten(double exponent) { return std::floor(std::pow(10.0, exponent) + 0.5); }

}  // namespace gridlock
