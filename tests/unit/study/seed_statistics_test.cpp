#include "study/seed_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace gridlock {
namespace {

/// How often Student's |t| exceeds x, by the midpoint rule in the angle atan(t/√n), where the density is cosⁿ⁻¹.
double chance_beyond(double x, double n) {
  double const normalisation =
      std::exp(std::lgamma(0.5 * (n + 1.0)) - std::lgamma(0.5 * n)) / std::sqrt(std::numbers::pi);
  double const from = std::atan(x / std::sqrt(n));
  double const width = 0.5 * std::numbers::pi - from;
  constexpr int points = 20'000;
  double sum = 0.0;
  for (int i = 0; i < points; ++i) sum += std::pow(std::cos(from + width * (i + 0.5) / points), n - 1.0);
  return 2.0 * normalisation * sum * width / points;
}

TEST(ThreeSigma, IsExceededByChanceAsOftenAsThreeStandardDeviationsOfANormalDistribution) {
  double const expected = std::erfc(3.0 / std::numbers::sqrt2);
  for (std::size_t degrees = 1; degrees <= 60; ++degrees) {
    EXPECT_NEAR(chance_beyond(three_sigma(degrees), static_cast<double>(degrees)) / expected, 1.0, 0.02) << degrees;
  }
}

}  // namespace
}  // namespace gridlock
