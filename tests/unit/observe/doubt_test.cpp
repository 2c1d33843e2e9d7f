#include "observe/doubt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

/// Samples of variance 1 that remember as many samples.
std::vector<double> remembering(std::uint64_t seed, std::size_t count, double memory) {
  RandomStream random(seed, 0, 0, Purpose::model_start);
  double const kept = memory > 0.0 ? std::exp(-1.0 / memory) : 0.0;
  double value = random.normal();
  std::vector<double> series;
  for (std::size_t k = 0; k < count; ++k) {
    series.push_back(3.0 + value);
    value = kept * value + std::sqrt(1.0 - kept * kept) * random.normal();
  }
  return series;
}

/// A run whose first fifth is left out.
std::optional<Doubt> doubt_of(std::vector<double> const& series) {
  std::span const all(series);
  std::size_t const left_out = series.size() / 5;
  return find_doubt(all.first(left_out), all.subspan(left_out));
}

double share_accused(double memory, std::size_t count, std::uint64_t runs) {
  std::uint64_t accused = 0;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) accused += doubt_of(remembering(seed, count, memory)) ? 1 : 0;
  return static_cast<double>(accused) / static_cast<double>(runs);
}

TEST(Doubt, DoesNotAccuseHonestSeries) {
  EXPECT_LE(share_accused(0.0, 1000, 4000), 0.002);
  EXPECT_LE(share_accused(0.0, 100, 4000), 0.002);
  EXPECT_LE(share_accused(2.0, 800, 4000), 0.005) << "a memory of a tenth of a block";
}

TEST(Doubt, AccusesSeriesThatRememberLongerThanABlock) {
  EXPECT_GE(share_accused(80.0, 1000, 300), 0.9);
  std::optional<Doubt> const doubt = doubt_of(remembering(7, 1000, 200.0));
  ASSERT_TRUE(doubt && doubt->times_seen);
  EXPECT_LT(*doubt->times_seen, 10.0);
  EXPECT_GT(*doubt->times_seen, 0.5);
}

TEST(Doubt, AccusesExcursionsThatFellIntoWhatIsLeftOut) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> series = remembering(seed, 1000, 0.0);
    for (std::size_t k = 130; k < 180; ++k) series[k] += 2.0;
    std::optional<Doubt> const doubt = doubt_of(series);
    ASSERT_TRUE(doubt && doubt->differs_by) << seed;
    EXPECT_GT(*doubt->differs_by, 4.0);
  }
}

TEST(Doubt, AccusesAMeanWhoseScatterIsOneRareEvent) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<double> series = remembering(seed, 1000, 0.0);
    for (std::size_t k = 606; k < 618; ++k) series[k] += 8.0;
    std::optional<Doubt> const doubt = doubt_of(series);
    ASSERT_TRUE(doubt && doubt->times_seen) << seed;
    EXPECT_LT(*doubt->times_seen, 3.0);
  }
}

TEST(Doubt, DoesNotMindAStartThatIsForgottenInTime) {
  std::uint64_t accused = 0;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    std::vector<double> series = remembering(seed, 1000, 1.0);
    for (std::size_t k = 0; k < 100; ++k) series[k] += 50.0 * std::exp(-0.1 * static_cast<double>(k));
    accused += doubt_of(series) ? 1 : 0;
  }
  EXPECT_LE(accused, 3U);
}

TEST(Doubt, SaysNothingOfFewSamplesAndOfConstants) {
  EXPECT_FALSE(find_doubt({}, remembering(1, 63, 1000.0)));
  EXPECT_FALSE(doubt_of(std::vector<double>(1000, 0.1)));
  std::vector<double> nearly(1000, 0.1);
  for (std::size_t k = 500; k < 1000; ++k) nearly[k] = std::nextafter(0.1, 1.0);
  EXPECT_FALSE(doubt_of(nearly)) << "rounding is no drift";
}

}  // namespace
}  // namespace gridlock
