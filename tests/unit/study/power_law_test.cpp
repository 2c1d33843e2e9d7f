#include "study/power_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

std::vector<PowerLawPoint> law(double noise, std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  std::vector<PowerLawPoint> points;
  for (double const n : {100.0, 200.0, 400.0, 700.0, 1100.0}) {
    for (double const k : {10.0, 15.0, 20.0}) {
      points.push_back({{n, k}, 3.0 * std::pow(n, 1.7) * std::pow(k, -2.2) * std::exp(noise * random.normal())});
    }
  }
  return points;
}

TEST(PowerLaw, IsFoundExactlyWhereThereIsOne) {
  auto const fit = fit_power_law(law(0.0, 1));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->prefactor, 3.0, 1e-9);
  EXPECT_NEAR(fit->exponents[0].value, 1.7, 1e-12);
  EXPECT_NEAR(fit->exponents[1].value, -2.2, 1e-12);
  EXPECT_LT(fit->exponents[0].error.value(), 1e-12);
}

TEST(PowerLaw, ErrorsAreTheScatterOfFitsToNoisyPoints) {
  constexpr int fits = 2000;
  for (std::size_t which : {0, 1}) {
    double const truth = which == 0 ? 1.7 : -2.2;
    double squared_deviation = 0.0;
    double squared_error = 0.0;
    for (std::uint64_t seed = 0; seed < fits; ++seed) {
      auto const fit = fit_power_law(law(0.1, seed));
      ASSERT_TRUE(fit);
      squared_deviation += std::pow(fit->exponents[which].value - truth, 2);
      squared_error += std::pow(fit->exponents[which].error.value(), 2);
    }
    // A variance from 2000 deviations is known to √(2/2000) = 3.2 %.
    EXPECT_NEAR(squared_error / squared_deviation, 1.0, 0.13) << which;
  }
}

TEST(PowerLaw, HasNoErrorsWhereThePointsJustDetermineIt) {
  std::vector<PowerLawPoint> const points{{{1.0}, 5.0}, {{2.0}, 40.0}};
  auto const fit = fit_power_law(points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->exponents[0].value, 3.0, 1e-12);
  EXPECT_FALSE(fit->exponents[0].error);
}

TEST(PowerLaw, IsNoneWhereThePointsDoNotDetermineIt) {
  EXPECT_FALSE(fit_power_law({}));
  EXPECT_FALSE(fit_power_law(std::vector<PowerLawPoint>{{{2.0}, 1.0}}));
  // k never changes, so its exponent could be anything.
  EXPECT_FALSE(fit_power_law(std::vector<PowerLawPoint>{{{1.0, 10.0}, 1.0}, {{2.0, 10.0}, 4.0}, {{3.0, 10.0}, 9.0}}));
}

}  // namespace
}  // namespace gridlock
