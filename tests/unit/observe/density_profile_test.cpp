#include "observe/density_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;
using Axis = DensityProfile::Axis;
using std::numbers::pi;

/// The table of a profile of some states, one after the other.
Distribution profile_of(std::vector<State> const& states, Axis axis, std::uint64_t bins) {
  DensityProfile profile(axis, bins);
  profile.begin({states.front(), {}});
  for (State const& state : states) sample(profile, state);
  auto const distributions = profile.distributions();
  EXPECT_EQ(distributions.size(), 1U);
  return distributions.empty() ? Distribution{} : distributions[0];
}

double mean_of(std::vector<double> const& values) {
  double sum = 0.0;
  for (double const value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

TEST(DensityProfile, CountsCentresPerAreaInStripsAlongEitherAxis) {
  State state = empty_state(Box(4.0, 10.0, Edge::wall));
  for (Vector const p : {Vector{0.5, 1.0}, Vector{1.5, 1.5}, Vector{1.6, 9.5}}) add_disk(state, p, {}, 0.1);
  Distribution const along_y = profile_of({state}, Axis::y, 5);
  EXPECT_EQ(along_y.name, "density_profile_y");
  EXPECT_EQ(along_y.columns_of_values[0], (std::vector<double>{1.0, 3.0, 5.0, 7.0, 9.0}));
  EXPECT_EQ(along_y.columns_of_values[1], (std::vector<double>{2.0 / 8.0, 0.0, 0.0, 0.0, 1.0 / 8.0}));
  Distribution const along_x = profile_of({state}, Axis::x, 4);
  EXPECT_EQ(along_x.name, "density_profile_x");
  EXPECT_EQ(along_x.columns_of_values[0], (std::vector<double>{0.5, 1.5, 2.5, 3.5}));
  EXPECT_EQ(along_x.columns_of_values[1], (std::vector<double>{1.0 / 10.0, 2.0 / 10.0, 0.0, 0.0}));
}

TEST(DensityProfile, GivesEachStripThePartOfADiskInsideIt) {
  State state = empty_state(Box(3.0, 4.0, Edge::wall));
  add_disk(state, {1.5, 2.0}, {}, 1.0);
  // Strips of width 0.5: the disk reaches from the third to the sixth, and is symmetric about y = 2.
  auto const covered = profile_of({state}, Axis::y, 8).columns_of_values[3];
  double const cap = pi / 3.0 - std::sqrt(3.0) / 4.0;  // of height 1/2
  double const strip = 1.5;
  std::vector<double> const expected{0.0, 0.0, cap, pi / 2.0 - cap, pi / 2.0 - cap, cap, 0.0, 0.0};
  for (std::size_t b = 0; b < expected.size(); ++b) EXPECT_NEAR(covered[b], expected[b] / strip, 1e-14) << b;
}

TEST(DensityProfile, ADiskAcrossAPeriodicEdgeCoversStripsOnBothSides) {
  for (Edge const edge_x : {Edge::periodic, Edge::wall}) {
    State state = empty_state(Box(3.0, 4.0, edge_x, Edge::periodic));
    add_disk(state, {1.0, 0.25}, {}, 0.5);
    auto const covered = profile_of({state}, Axis::y, 4).columns_of_values[3];
    double const beyond = 0.25 * (pi / 3.0 - std::sqrt(3.0) / 4.0);  // a cap of half the radius
    EXPECT_NEAR(covered[0], (pi / 4.0 - beyond) / 3.0, 1e-14);
    EXPECT_EQ(covered[1], 0.0);
    EXPECT_EQ(covered[2], 0.0);
    EXPECT_NEAR(covered[3], beyond / 3.0, 1e-14);
  }
}

TEST(DensityProfile, ItsMeanIsThatOfTheBoxInOblongBoxesOfEitherEdge) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (Axis const axis : {Axis::x, Axis::y}) {
      for (std::uint64_t const bins : {1U, 3U, 1000U}) {
        State const state = ideal_gas(Box(7.0, 2.0, edge), 60, 0.2, 4);
        auto const columns = profile_of({state}, axis, bins).columns_of_values;
        EXPECT_NEAR(mean_of(columns[1]), 60.0 / 14.0, 1e-12);
        EXPECT_NEAR(mean_of(columns[3]), 60.0 * pi * 0.04 / 14.0, 1e-12);
      }
    }
  }
}

TEST(DensityProfile, LeavesFixedDisksOut) {
  State state = empty_state(Box(4.0, 2.0, Edge::wall));
  add_disk(state, {1.0, 0.5}, {}, 0.1);
  add_disk(state, {3.0, 1.5}, {}, 0.1, std::numeric_limits<double>::infinity());
  auto const columns = profile_of({state}, Axis::y, 2).columns_of_values;
  EXPECT_EQ(columns[1], (std::vector<double>{0.25, 0.0}));
  EXPECT_EQ(columns[3][1], 0.0);
}

TEST(DensityProfile, AveragesOverSamplesThatCountWithAnErrorFromBlocks) {
  State low = empty_state(Box(2.0, 2.0, Edge::wall));
  add_disk(low, {1.0, 0.5}, {}, 0.1);
  State high = empty_state(Box(2.0, 2.0, Edge::wall));
  add_disk(high, {1.0, 1.5}, {}, 0.1);
  DensityProfile profile(Axis::y, 2);
  profile.begin({low, {}});
  EXPECT_TRUE(profile.distributions().empty());
  sample(profile, low, {}, false);
  EXPECT_TRUE(profile.distributions().empty());
  for (int k = 0; k < 3; ++k) sample(profile, high);
  sample(profile, low);
  auto const columns = profile.distributions()[0].columns_of_values;
  EXPECT_EQ(columns[1], (std::vector<double>{0.5 / 4.0, 1.5 / 4.0}));
  // Four samples 0, 0, 0, 1/2: √(Σ (v − mean)² / (4·3)).
  EXPECT_NEAR(columns[2][0], std::sqrt((3.0 * 0.125 * 0.125 + 0.375 * 0.375) / 12.0), 1e-15);
}

}  // namespace
}  // namespace gridlock
