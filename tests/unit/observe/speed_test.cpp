#include "observe/speed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

constexpr double range = 3.0;
constexpr std::uint64_t bins = 60;

State moving_disks(std::vector<Vector> const& velocities, std::vector<double> const& masses = {}) {
  State state = empty_state(Box(1, 1, Edge::wall));
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    add_disk(state, {0.5, 0.5}, velocities[i], 0.01, masses.empty() ? 1.0 : masses[i]);
  }
  return state;
}

TEST(Speed, EquallyFastDisksHaveMomentRatioOne) {
  State const state = moving_disks({{3, 4}, {-5, 0}, {0, 5}, {4, -3}});
  Speed speed(range, bins);
  speed.begin({state, {}});
  auto const row = sample(speed, state);
  EXPECT_DOUBLE_EQ(cell(speed, row, "mean_speed"), 5.0);
  EXPECT_DOUBLE_EQ(cell(speed, row, "speed_moment_ratio"), 1.0);
}

TEST(Speed, MomentsOfUnequalSpeeds) {
  // Speeds 1, 2, 3: mean 2, ⟨v⁴⟩/⟨v²⟩² = (98/3)/(14/3)².
  State const state = moving_disks({{1, 0}, {0, 2}, {-3, 0}});
  Speed speed(range, bins);
  speed.begin({state, {}});
  auto const row = sample(speed, state);
  EXPECT_DOUBLE_EQ(cell(speed, row, "mean_speed"), 2.0);
  EXPECT_DOUBLE_EQ(cell(speed, row, "speed_moment_ratio"), 98.0 / 3.0 / (14.0 * 14.0 / 9.0));
}

TEST(Speed, MomentRatioOfAMixtureComparesEnergies) {
  // ½·1·2² = ½·4·1²: the heavy disk is slower, but not colder.
  State const state = moving_disks({{2, 0}, {0, 1}}, {1.0, 4.0});
  Speed speed(range, bins);
  speed.begin({state, {}});
  EXPECT_DOUBLE_EQ(cell(speed, sample(speed, state), "speed_moment_ratio"), 1.0);
}

TEST(Speed, MaxwellsCurveIntegratesToItsShareWithinTheRange) {
  // For equal masses the range is 3 √⟨v²⟩ = 3 √(2kT/m), beyond which lies exp(−9).
  State state = ideal_gas(Box(1, 1, Edge::wall), 100, 0.01, 1);
  draw_maxwell(state, 2.0, 1);
  Speed speed(range, bins);
  speed.begin({state, {}});
  sample(speed, state);
  auto const distributions = speed.distributions();
  ASSERT_EQ(distributions.size(), 1U);
  EXPECT_EQ(distributions[0].name, "speed_distribution");
  auto const& values = distributions[0].columns_of_values;
  ASSERT_EQ(values.size(), distributions[0].columns.size());
  double const width = values[0][1] - values[0][0];
  EXPECT_NEAR(std::accumulate(values[3].begin(), values[3].end(), 0.0) * width, 1.0 - std::exp(-9.0), 1e-12);
}

TEST(Speed, HistogramIsADensityOverAllDisks) {
  // Speeds 1, 1, 1, 9: the last is beyond the range 1.5 √21 = 6.87 and the others fill one bin.
  State const state = moving_disks({{1, 0}, {0, 1}, {-1, 0}, {0, 9}});
  Speed speed(1.5, 10);
  speed.begin({state, {}});
  sample(speed, state);
  auto const values = speed.distributions()[0].columns_of_values;
  double const width = 1.5 * std::sqrt(21.0) / 10.0;
  for (std::size_t b = 0; b < 10; ++b) {
    EXPECT_NEAR(values[0][b], (static_cast<double>(b) + 0.5) * width, 1e-12);
    EXPECT_NEAR(values[1][b], b == 1 ? 0.75 / width : 0.0, 1e-12) << b;
    EXPECT_TRUE(std::isnan(values[2][b])) << "one sample has no error";
  }
}

TEST(Speed, TheHistogramOfAMixtureReachesToMultiplesOfTheSpeedOfItsLightestDisks) {
  // Equal energies per disk: √⟨v²⟩ is 6 for the light disks and 2 for those of nine times the mass.
  State const state = moving_disks({{2, 0}, {0, 6}, {0, -2}}, {9.0, 1.0, 9.0});
  Speed speed(range, bins);
  speed.begin({state, {}});
  sample(speed, state);
  std::vector<double> const speeds = speed.distributions()[0].columns_of_values[0];
  double const width = speeds[1] - speeds[0];
  EXPECT_NEAR(speeds.back() + 0.5 * width, range * 6.0, 1e-12);
}

TEST(Speed, DrawnMaxwellVelocitiesFallOnMaxwellsCurveForAMixture) {
  // 40 independent samples; in each bin (measured − Maxwell)/error is Student's t, with variance 31/29 for 32 blocks
  // of one or two samples. The temperature is that of the samples, a relative uncertainty of 1/√(40·500).
  State state = empty_state(Box(1, 1, Edge::wall));
  for (int i = 0; i < 500; ++i) add_disk(state, {0.5, 0.5}, {}, 0.01, i % 3 == 0 ? 5.0 : 1.0);
  Speed speed(range, bins);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    draw_maxwell(state, 0.7, seed);
    if (seed == 0) speed.begin({state, {}});
    sample(speed, state);
  }
  auto const values = speed.distributions()[0].columns_of_values;
  double sum = 0.0;
  int compared = 0;
  for (std::size_t b = 0; b < bins; ++b) {
    if (values[1][b] * 40 * 500 * (values[0][1] - values[0][0]) < 30) continue;  // too few for a normal error
    double const pull = (values[1][b] - values[3][b]) / values[2][b];
    EXPECT_LT(std::abs(pull), 4.5) << "speed " << values[0][b];
    sum += pull * pull;
    ++compared;
  }
  ASSERT_GT(compared, 30);
  EXPECT_NEAR(sum / compared, 1.1, 4.0 * std::sqrt(2.0 / compared));
}

TEST(Speed, DisksAtRestHaveNoRatioAndNoDistribution) {
  State const state = moving_disks({{0, 0}, {0, 0}});
  Speed speed(range, bins);
  speed.begin({state, {}});
  auto const row = sample(speed, state);
  EXPECT_EQ(cell(speed, row, "mean_speed"), 0.0);
  EXPECT_TRUE(std::isnan(cell(speed, row, "speed_moment_ratio")));
  EXPECT_FALSE(result(speed, "speed_moment_ratio"));
  EXPECT_TRUE(speed.distributions().empty());
}

}  // namespace
}  // namespace gridlock
