#include "study/seed_statistics.hpp"

#include <array>
#include <cassert>

namespace gridlock {

double three_sigma(std::size_t degrees_of_freedom) {
  assert(degrees_of_freedom >= 1);
  constexpr std::array few{235.784, 19.206, 9.219, 6.620, 5.507, 4.904, 4.530, 4.277};
  if (degrees_of_freedom <= few.size()) return few[degrees_of_freedom - 1];
  // 26.7.5 with the normal quantile x = 3.
  double const n = static_cast<double>(degrees_of_freedom);
  return 3.0 + (27.0 + 3.0) / (4.0 * n) + (5.0 * 243.0 + 16.0 * 27.0 + 9.0) / (96.0 * n * n) +
         (3.0 * 2187.0 + 19.0 * 243.0 + 17.0 * 27.0 - 15.0 * 3.0) / (384.0 * n * n * n);
}

}  // namespace gridlock
