#include "observe/mean_over_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

namespace gridlock {
namespace {

TEST(MeanOverRuns, HasTheTextbookStandardError) {
  std::vector<double> const values{1.0, 2.0, 3.0, 6.0};
  Estimate const estimate = mean_over_runs(values);
  EXPECT_DOUBLE_EQ(estimate.value, 3.0);
  // Squared deviations 4 + 1 + 0 + 9, over n (n − 1) = 12.
  ASSERT_TRUE(estimate.error);
  EXPECT_DOUBLE_EQ(*estimate.error, std::sqrt(14.0 / 12.0));
}

TEST(MeanOverRuns, ClaimsNoErrorForOneRun) {
  EXPECT_FALSE(mean_over_runs(std::vector{0.3}).error);
  EXPECT_EQ(mean_over_runs(std::vector{0.3}).value, 0.3);
}

TEST(Combine, TakesTheLargerOneOfTwoErrorsAndTellsWhetherTheRunsAgree) {
  CombinedEstimate const apart = combine(std::vector<Estimate>{{1.0, 0.1}, {1.4, 0.1}});
  EXPECT_DOUBLE_EQ(apart.mean.value, 1.2);
  EXPECT_DOUBLE_EQ(*apart.mean.error, 0.2);
  EXPECT_DOUBLE_EQ(*apart.error_by_runs, 0.1 / std::sqrt(2.0));
  EXPECT_NEAR(*apart.chi_squared, 8.0, 1e-12);
  CombinedEstimate const together = combine(std::vector<Estimate>{{1.0, 0.3}, {1.0, 0.4}});
  EXPECT_DOUBLE_EQ(*together.mean.error, 0.25);
  EXPECT_EQ(*together.error_by_scatter, 0.0);
  EXPECT_EQ(*together.chi_squared, 0.0);
}

TEST(Combine, HasOnlyTheErrorsThatThereAre) {
  CombinedEstimate const one = combine(std::vector<Estimate>{{2.0, 0.5}});
  EXPECT_EQ(*one.mean.error, 0.5);
  EXPECT_FALSE(one.error_by_scatter);
  CombinedEstimate const without = combine(std::vector<Estimate>{{1.0, std::nullopt}, {3.0, 0.1}});
  EXPECT_DOUBLE_EQ(*without.mean.error, 1.0);
  EXPECT_FALSE(without.error_by_runs);
  EXPECT_FALSE(without.chi_squared);
  EXPECT_FALSE(combine(std::vector<Estimate>{{1.0, std::nullopt}}).mean.error);
}

}  // namespace
}  // namespace gridlock
