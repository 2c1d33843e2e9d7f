#pragma once

#include <cmath>
#include <vector>

namespace gridlock::reference {

struct Estimate {
  double value = 0.0;
  double error = 0.0;  ///< standard error
};

/// The mean of independent values, and the standard error of that mean.
inline Estimate mean_of(std::vector<double> const& values) {
  auto const count = static_cast<double>(values.size());
  double sum = 0.0;
  for (double const value : values) sum += value;
  double squares = 0.0;
  for (double const value : values) squares += (value - sum / count) * (value - sum / count);
  return {sum / count, std::sqrt(squares / (count * (count - 1.0)))};
}

}  // namespace gridlock::reference
