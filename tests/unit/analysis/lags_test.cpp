#include "analysis/lags.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "gridlock/core/error.hpp"

namespace gridlock {
namespace {

std::vector<double> values_of(std::vector<FramesOfLag> const& lags) {
  std::vector<double> values;
  for (FramesOfLag const& frames : lags) values.push_back(frames.lag());
  return values;
}

TEST(Lags, OfEvenFramesAreTheMultiplesOfTheirDistance) {
  std::vector<double> const times{10.0, 12.0, 14.0, 16.0};
  auto const lags = lags_between(times, 0);
  EXPECT_EQ(values_of(lags), (std::vector<double>{2.0, 4.0, 6.0}));
  ASSERT_EQ(lags[1].size(), 2U);
  EXPECT_EQ(lags[1][1], (std::pair<std::size_t, std::size_t>(1, 3)));
}

TEST(Lags, OfUnevenFramesAreFoundWhereverTheyAre) {
  std::vector<double> const times{0.0, 1.0, 3.0, 10.0, 11.0, 13.0};
  auto const lags = lags_between(times, 0);
  EXPECT_EQ(values_of(lags), (std::vector<double>{1.0, 2.0, 3.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0}));
  ASSERT_EQ(lags[0].size(), 2U);
  EXPECT_EQ(lags[0][1], (std::pair<std::size_t, std::size_t>(3, 4)));
  ASSERT_EQ(lags[6].size(), 3U);
  EXPECT_EQ(lags[6][2], (std::pair<std::size_t, std::size_t>(2, 5))) << "in the order of the origins";
}

TEST(Lags, OfManyUnevenFramesHaveTheirPairsInTheOrderOfTheirOrigins) {
  std::vector<double> times;
  for (int f = 0; f < 60; ++f) times.push_back(0.1 * f + (f % 3 == 2 ? 0.05 : 0.0));
  std::size_t most = 0;
  for (FramesOfLag const& frames : lags_between(times, 0)) {
    most = std::max(most, frames.size());
    for (std::size_t k = 1; k < frames.size(); ++k) EXPECT_LT(frames[k - 1].first, frames[k].first) << frames.lag();
  }
  EXPECT_GT(most, 20U);
}

TEST(Lags, ThatDifferByRoundingAreOne) {
  std::vector<double> const times{0.0, 0.1, 0.3, 0.1 + 0.3, 0.7, 0.1 + 0.7};
  auto const lags = lags_between(times, 0);
  EXPECT_NEAR(lags[0].lag(), 0.1, 1e-12);
  EXPECT_EQ(lags[0].size(), 3U);
}

TEST(Lags, ThatAreChosenAreEvenInTheLogarithm) {
  std::vector<double> times;
  for (int f = 0; f <= 1000; ++f) times.push_back(f);
  EXPECT_EQ(values_of(lags_between(times, 4)), (std::vector<double>{1.0, 10.0, 100.0, 1000.0}));
  EXPECT_EQ(values_of(lags_between(times, 1)), (std::vector<double>{1.0}));
  EXPECT_EQ(lags_between(times, 5000).size(), 1000U);
  EXPECT_LT(lags_between(times, 100).size(), 100U) << "near the start there are no hundred lags";
}

TEST(Lags, AreRefusedWhereTimesDoNotAscend) {
  EXPECT_THROW(lags_between(std::vector<double>{1.0}, 0), Error);
  EXPECT_THROW(lags_between(std::vector<double>{1.0, 1.0}, 0), Error);
  EXPECT_THROW(lags_between(std::vector<double>{1.0, 0.5}, 0), Error);
  EXPECT_THROW(lags_between(std::vector<double>{1.0, std::nan("")}, 0), Error);
}

TEST(Lags, OfTooManyUnevenFramesAreRefused) {
  std::vector<double> times;
  for (int f = 0; f < 9000; ++f) times.push_back(f + (f > 5 ? 0.5 : 0.0));
  EXPECT_THROW(lags_between(times, 10), Error);
}

}  // namespace
}  // namespace gridlock
