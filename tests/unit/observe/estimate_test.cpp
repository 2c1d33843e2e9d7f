#include "gridlock/observe/estimate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

TEST(EstimateFromBlocks, EqualBlocksGiveTheTextbookStandardError) {
  // Means 1, 2, 3, 6: mean 3, Σ(m − 3)² = 4 + 1 + 0 + 9 = 14, error² = 14 / (4·3).
  std::array<Block, 4> const blocks{{{10, 10}, {20, 10}, {30, 10}, {60, 10}}};
  auto const estimate = estimate_from(blocks);
  ASSERT_TRUE(estimate && estimate->error);
  EXPECT_DOUBLE_EQ(estimate->value, 3.0);
  EXPECT_DOUBLE_EQ(*estimate->error, std::sqrt(14.0 / 12.0));
}

TEST(EstimateFromBlocks, NoWeightIsNoEstimateAndOneBlockHasNoError) {
  EXPECT_FALSE(estimate_from({}));
  std::array<Block, 3> blocks{};
  EXPECT_FALSE(estimate_from(blocks));
  blocks[1] = {6, 2};
  auto const estimate = estimate_from(blocks);
  ASSERT_TRUE(estimate);
  EXPECT_EQ(estimate->value, 3.0);
  EXPECT_FALSE(estimate->error);
}

TEST(EstimateFromBlocks, EmptyBlocksChangeNothing) {
  std::array<Block, 2> const without{{{1, 1}, {5, 2}}};
  std::array<Block, 4> const with{{{0, 0}, {1, 1}, {0, 0}, {5, 2}}};
  EXPECT_EQ(estimate_from(without)->value, estimate_from(with)->value);
  EXPECT_EQ(*estimate_from(without)->error, *estimate_from(with)->error);
}

TEST(EstimateFromBlocks, SquaredErrorIsUnbiasedForUnequalBlocksOfIndependentSamples) {
  // n independent samples of variance 1: the variance of their mean is 1/n however they are cut into blocks, and the
  // expectation of the squared error must be just that.
  std::vector<int> const sizes{1, 7, 2, 20, 5, 5, 13, 1};
  constexpr double n = 54;
  constexpr int replicas = 20'000;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (int replica = 0; replica < replicas; ++replica) {
    RandomStream random(1, static_cast<std::uint64_t>(replica), 0, Purpose::start_velocity);
    std::vector<Block> blocks;
    for (int const size : sizes) {
      Block block;
      for (int s = 0; s < size; ++s) block.add({random.normal(), 1.0});
      blocks.push_back(block);
    }
    double const squared_error = std::pow(*estimate_from(blocks)->error, 2);
    sum += squared_error;
    sum_of_squares += squared_error * squared_error;
  }
  double const mean = sum / replicas;
  double const standard_error = std::sqrt((sum_of_squares / replicas - mean * mean) / replicas);
  EXPECT_NEAR(mean, 1.0 / n, 4.0 * standard_error);
  EXPECT_LT(standard_error, 0.01 / n);
}

}  // namespace
}  // namespace gridlock
