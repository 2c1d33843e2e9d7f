#include "observe/mean_over_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
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

}  // namespace
}  // namespace gridlock
