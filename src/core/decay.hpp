#pragma once

namespace gridlock {

/// Returns e^(−x) for x ≥ 0, to a few last digits for small x. Only the four operations are used, so that every
/// compiler gives the same bits; std::exp does not, and must not be used for values that enter a state.
inline double decay(double x) {
  constexpr double smallest_exponent = 745.0;
  if (!(x < smallest_exponent)) return 0.0;
  int halvings = 0;
  for (; x > 0x1p-4; ++halvings) x *= 0.5;
  // The series of e^(−x); its term 12 is below 10⁻²³.
  double sum = 1.0;
  for (int k = 12; k > 0; --k) sum = 1.0 - sum * x / static_cast<double>(k);
  for (; halvings > 0; --halvings) sum *= sum;
  return sum;
}

}  // namespace gridlock
