#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/observe/estimate.hpp"

namespace gridlock {
namespace {

TEST(BlockAverage, HasNoEstimateWithoutSamplesAndNoErrorForOne) {
  BlockAverage average;
  EXPECT_FALSE(average.estimate());
  EXPECT_TRUE(average.block_means().empty());
  average.add(2.5);
  EXPECT_EQ(average.estimate()->value, 2.5);
  EXPECT_FALSE(average.estimate()->error);
  average.add(3.5);
  EXPECT_EQ(average.estimate()->value, 3.0);
  EXPECT_DOUBLE_EQ(*average.estimate()->error, 0.5);
}

TEST(BlockAverage, BlocksAreEqualConsecutivePiecesOfTheSeriesWhateverItsLength) {
  BlockAverage average;
  std::vector<double> series;
  for (std::size_t n = 1; n <= 1100; ++n) {
    series.push_back(RandomStream(2, n, 0, Purpose::start_velocity).normal());
    average.add(series.back());
    ASSERT_EQ(average.samples(), n);
    auto const blocks = average.blocks();
    ASSERT_LE(blocks.size(), BlockAverage::max_blocks);
    ASSERT_GE(blocks.size(), std::min<std::size_t>(n, 17)) << n;
    // The length of a block is the smallest power of two for which the series fits.
    std::size_t length = 1;
    while (length * BlockAverage::max_blocks < n) length *= 2;
    ASSERT_EQ(blocks.size(), (n + length - 1) / length) << n;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      Block expected;
      for (std::size_t s = b * length; s < std::min(n, (b + 1) * length); ++s) expected.add({series[s], 1.0});
      ASSERT_EQ(blocks[b].weight, expected.weight) << n;
      ASSERT_NEAR(blocks[b].sum, expected.sum, 1e-12) << n;
      ASSERT_NEAR(average.block_means()[b], expected.sum / expected.weight, 1e-12) << n;
    }
  }
}

TEST(BlockAverage, WeightsMakeRatesOutOfIntervalsOfAnyLength) {
  // 3 events in 1 s, none in 2 s, 9 in 3 s: 2 a second.
  BlockAverage average;
  average.add(3.0 / 1.0, 1.0);
  average.add(0.0 / 2.0, 2.0);
  average.add(9.0 / 3.0, 3.0);
  EXPECT_DOUBLE_EQ(average.estimate()->value, 2.0);
}

TEST(BlockAverage, ConstantSeriesHasErrorZero) {
  BlockAverage average;
  for (int n = 0; n < 1000; ++n) average.add(0.75);
  EXPECT_EQ(average.estimate()->value, 0.75);
  EXPECT_EQ(*average.estimate()->error, 0.0);
}

/// The variance of the mean of n neighbouring samples of the autoregressive process x' = a x + noise with variance 1:
///     (1/n) [(1 + a)/(1 − a) − 2a (1 − aⁿ) / (n (1 − a)²)]
/// by summing the autocorrelation a^|s − t| over all pairs of samples.
double variance_of_mean(double a, double n) {
  return ((1.0 + a) / (1.0 - a) - 2.0 * a * (1.0 - std::pow(a, n)) / (n * (1.0 - a) * (1.0 - a))) / n;
}

TEST(BlockAverage, FindsTheExactErrorOfAnAutoregressiveProcess) {
  constexpr double a = 0.8;
  constexpr int n = 4096;  // 32 blocks of 128 samples
  constexpr int replicas = 400;
  double squared_errors = 0.0;
  double squared_squares = 0.0;
  double squared_means = 0.0;
  for (int replica = 0; replica < replicas; ++replica) {
    RandomStream random(3, static_cast<std::uint64_t>(replica), 0, Purpose::start_velocity);
    BlockAverage average;
    double x = random.normal();
    for (int s = 0; s < n; ++s) {
      average.add(x);
      x = a * x + std::sqrt(1.0 - a * a) * random.normal();
    }
    ASSERT_EQ(average.blocks().size(), 32U);
    double const squared = std::pow(*average.estimate()->error, 2);
    squared_errors += squared / replicas;
    squared_squares += squared * squared / replicas;
    squared_means += std::pow(average.estimate()->value, 2) / replicas;
  }
  // E Σ(m_b − m)² = 32 (var m_b − var m) exactly, so that the blocks' expectation is (var m_b − var m)/31.
  double const expected = (variance_of_mean(a, n / 32) - variance_of_mean(a, n)) / 31.0;
  double const standard_error = std::sqrt((squared_squares - squared_errors * squared_errors) / replicas);
  EXPECT_NEAR(squared_errors, expected, 4.0 * standard_error);
  // Blocks of 128 samples against a memory of 9: within 4 % of the true variance, where single samples would be off by
  // 9.
  EXPECT_NEAR(expected / variance_of_mean(a, n), 1.0, 0.04);
  // The means of 400 independent series scatter as the exact formula says (χ² with 400 degrees: 7 %).
  EXPECT_NEAR(squared_means / variance_of_mean(a, n), 1.0, 4.0 * std::sqrt(2.0 / replicas));
}

TEST(BlockAverage, ErrorOfIndependentSamplesIsTrueToWithinItsOwnUncertainty) {
  // For every length the squared error must have the expectation 1/n, with full blocks and with a short last one.
  for (int const n : {2, 5, 16, 17, 32, 33, 50, 100, 1000}) {
    constexpr int replicas = 2000;
    double sum = 0.0;
    double squares = 0.0;
    for (int replica = 0; replica < replicas; ++replica) {
      RandomStream random(4, static_cast<std::uint64_t>(replica), static_cast<Id>(n), Purpose::start_velocity);
      BlockAverage average;
      for (int s = 0; s < n; ++s) average.add(random.normal());
      double const squared = std::pow(*average.estimate()->error, 2);
      sum += squared / replicas;
      squares += squared * squared / replicas;
    }
    EXPECT_NEAR(sum * n, 1.0, 4.0 * n * std::sqrt((squares - sum * sum) / replicas)) << n << " samples";
  }
}

}  // namespace
}  // namespace gridlock
