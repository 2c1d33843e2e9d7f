#include "observe/pair_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "observe/bond_orientation.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

using namespace hand_built;

TEST(ProbabilityOfNearerPoints, InAPeriodicBoxIsTheAreaOfTheDisk) {
  EXPECT_DOUBLE_EQ(probability_of_nearer_points(Box(2, 3, Edge::periodic), 0.5), std::numbers::pi * 0.25 / 6.0);
}

TEST(ProbabilityOfNearerPoints, BetweenWallsIsTheIntegralOverTheOverlapOfShiftedRectangles) {
  // Independent points of [0, W] × [0, H] differ by (u, v) with density (W − |u|)(H − |v|)/(WH)²; integrated over the
  // disk numerically, with the v integral done by hand.
  Box const box(1.3, 0.7, Edge::wall);
  for (double const r : {0.01, 0.2, 0.35, 0.7}) {
    constexpr int slices = 200'000;
    double sum = 0.0;
    for (int s = 0; s < slices; ++s) {
      double const u = r * (s + 0.5) / slices;
      double const v = std::sqrt(r * r - u * u);
      sum += (box.width() - u) * (box.height() * v - 0.5 * v * v) * r / slices;
    }
    EXPECT_NEAR(probability_of_nearer_points(box, r), 4.0 * sum / (box.area() * box.area()), 1e-8) << r;
  }
}

TEST(ProbabilityOfNearerPoints, InAChannelIsThatOfRandomPairs) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  for (Box const& box : {Box(1.3, 0.7, Edge::periodic, Edge::wall), Box(1.3, 0.7, Edge::wall, Edge::periodic)}) {
    constexpr int pairs = 400'000;
    double const r = 0.33;
    int nearer = 0;
    for (int n = 0; n < pairs; ++n) {
      Vector const a{box.width() * random.uniform(), box.height() * random.uniform()};
      Vector const b{box.width() * random.uniform(), box.height() * random.uniform()};
      nearer += squared_length(box.displacement(a, b)) < r * r ? 1 : 0;
    }
    double const expected = probability_of_nearer_points(box, r);
    EXPECT_NEAR(static_cast<double>(nearer) / pairs, expected, 4.0 * std::sqrt(expected * (1.0 - expected) / pairs));
  }
}

TEST(ProbabilityOfNearerPoints, InTheUnitSquareHasTheKnownValueAtDistanceOne) {
  EXPECT_NEAR(probability_of_nearer_points(Box(1, 1, Edge::wall), 1.0), std::numbers::pi - 13.0 / 6.0, 1e-15);
}

void expect_one_for_an_ideal_gas(Box const& box, std::size_t count) {
  // 64 independent samples in 32 blocks: (g − 1)/error is Student's t with 31 degrees of freedom, variance 31/29; with
  // 40 bins the mean square has the standard error √(2.3/40) of its value (kurtosis of t).
  constexpr double radius = 0.02;
  constexpr std::uint64_t bins = 40;
  PairCorrelation correlation(1, 8.0, bins);
  for (std::uint64_t seed = 0; seed < 64; ++seed) {
    State const state = ideal_gas(box, count, radius, seed);
    if (seed == 0) correlation.begin({state, {}});
    sample(correlation, state);
  }
  auto const distributions = correlation.distributions();
  ASSERT_EQ(distributions.size(), 1U);
  EXPECT_EQ(distributions[0].name, "pair_correlation");
  auto const& values = distributions[0].columns_of_values;
  ASSERT_EQ(values[0].size(), bins);
  double squares = 0.0;
  double weighted = 0.0;
  double weights = 0.0;
  for (std::size_t b = 0; b < bins; ++b) {
    double const pull = (values[1][b] - 1.0) / values[2][b];
    EXPECT_LT(std::abs(pull), 5.0) << "distance " << values[0][b];
    squares += pull * pull / bins;
    weights += values[0][b];
    weighted += values[0][b] * (values[1][b] - 1.0);
  }
  EXPECT_NEAR(squares, 31.0 / 29.0, 4.0 * std::sqrt(2.3 / bins));
  // All bins together: the number of pairs within the range, 64 N²/2 times its probability, to 4 of its standard
  // errors.
  double const n = static_cast<double>(count);
  double const range = values[0].back() + values[0].front();
  double const pairs = 64 * 0.5 * n * (n - 1) * std::numbers::pi * range * range / box.area();
  EXPECT_LT(std::abs(weighted / weights), 4.0 / std::sqrt(pairs));
}

TEST(PairCorrelation, OfAnIdealGasIsOneInAPeriodicBox) {
  expect_one_for_an_ideal_gas(Box(1.0, 1.4, Edge::periodic), 400);
}

TEST(PairCorrelation, OfAnIdealGasIsOneBetweenWalls) {
  expect_one_for_an_ideal_gas(Box(1.0, 1.4, Edge::wall), 400);
  // Up to half the side, where a third of the disks has no full circle around it.
  expect_one_for_an_ideal_gas(Box(0.5, 0.5, Edge::wall), 100);
}

TEST(PairCorrelation, OfAnIdealGasIsOneInAChannel) {
  expect_one_for_an_ideal_gas(Box(1.3, 0.8, Edge::periodic, Edge::wall), 150);
  expect_one_for_an_ideal_gas(Box(1.3, 0.8, Edge::wall, Edge::periodic), 150);
}

TEST(PairCorrelation, OfFewPointsIsOneToo) { expect_one_for_an_ideal_gas(Box(0.7, 0.7, Edge::periodic), 40); }

TEST(PairCorrelation, FindsTheShellsOfTheSquareLattice) {
  // 4 neighbours each at 1, √2 and 2: 200 pairs of the 100 disks in each shell.
  State const state = square_lattice(10);
  PairCorrelation correlation(1, 2.75, 44);  // of diameter 0.8: up to 2.2 in bins of 0.05
  correlation.begin({state, {}});
  sample(correlation, state);
  auto const values = correlation.distributions()[0].columns_of_values;
  ASSERT_NEAR(values[0][0], 0.025, 1e-12);
  auto const pairs_in = [&](std::size_t b) {
    double const inner = 0.05 * static_cast<double>(b);
    double const area = std::numbers::pi * 0.05 * (2.0 * inner + 0.05);
    return values[1][b] * 0.5 * 100 * 99 * area / 100.0;
  };
  for (std::size_t b = 0; b < 44; ++b) {
    // The shells at 1 and 2 lie on a border of bins and may be rounded into either.
    bool const has_shell = b == 19 || b == 20 || b == 28 || b == 39 || b == 40;
    EXPECT_TRUE(has_shell || pairs_in(b) == 0.0) << b;
  }
  EXPECT_NEAR(pairs_in(19) + pairs_in(20), 200.0, 1e-9);
  EXPECT_NEAR(pairs_in(28), 200.0, 1e-9);
  EXPECT_NEAR(pairs_in(39) + pairs_in(40), 200.0, 1e-9);
}

TEST(PairCorrelation, OfOrientationsIsTheMeanOverThePairs) {
  State const state = ideal_gas(Box(2, 3, Edge::periodic), 200, 0.05, 3);
  PairCorrelation correlation(1, 9.0, 6, true);
  correlation.begin({state, {}});
  sample(correlation, state);
  auto const values = correlation.distributions()[0].columns_of_values;
  auto const place = [&](std::size_t i) { return Vector{state.agents.column<X>()[i], state.agents.column<Y>()[i]}; };
  double const cutoff = neighbour_distance(state.box, 200);
  std::vector<std::complex<double>> psi;
  for (std::size_t i = 0; i < 200; ++i) {
    std::complex<double> sum;
    double neighbours = 0.0;
    for (std::size_t j = 0; j < 200; ++j) {
      Vector const d = state.box.displacement(place(i), place(j));
      if (i == j || squared_length(d) >= cutoff * cutoff) continue;
      sum += std::polar(1.0, 6.0 * std::atan2(d.y, d.x));
      neighbours += 1.0;
    }
    psi.push_back(neighbours > 0.0 ? sum / neighbours : 0.0);
  }
  std::vector<double> sums(6, 0.0), pairs(6, 0.0);
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      double const r = std::sqrt(squared_length(state.box.displacement(place(i), place(j))));
      if (r >= 0.9) continue;
      sums[static_cast<std::size_t>(r / 0.15)] += (std::conj(psi[i]) * psi[j]).real();
      pairs[static_cast<std::size_t>(r / 0.15)] += 1.0;
    }
  }
  for (std::size_t b = 0; b < 6; ++b) EXPECT_NEAR(values[3][b], sums[b] / pairs[b], 1e-9) << b;
  // g(r) itself does not change.
  PairCorrelation plain(1, 9.0, 6);
  plain.begin({state, {}});
  sample(plain, state);
  EXPECT_EQ(plain.distributions()[0].columns_of_values[1], values[1]);
}

TEST(PairCorrelation, OfOrientationsIsOneInALatticeAndNoNumberWithoutPairs) {
  State const state = triangular_lattice(12, 14);
  PairCorrelation correlation(1, 7.0, 56, true);
  correlation.begin({state, {}});
  sample(correlation, state);
  auto const values = correlation.distributions()[0].columns_of_values;
  for (std::size_t b = 0; b < values[3].size(); ++b) {
    if (values[1][b] > 0.0) {
      EXPECT_NEAR(values[3][b], 1.0, 1e-9) << b;
    } else {
      EXPECT_TRUE(std::isnan(values[3][b])) << b;
    }
  }
}

TEST(PairCorrelation, RangeEndsAtHalfTheShorterSide) {
  State const state = ideal_gas(Box(1, 3, Edge::periodic), 20, 0.2, 1);
  PairCorrelation correlation(1, 100.0, 10);
  correlation.begin({state, {}});
  sample(correlation, state);
  auto const distances = correlation.distributions()[0].columns_of_values[0];
  EXPECT_NEAR(distances.back(), 0.475, 1e-12);
}

TEST(PairCorrelation, IsLeftOutForFewerThanTwoDisksAndWhereWallsLeaveNoRoom) {
  for (std::size_t count : {0U, 1U}) {
    State const state = ideal_gas(Box(1, 1, Edge::periodic), count, 0.1, 1);
    PairCorrelation correlation(1, 5.0, 10);
    correlation.begin({state, {}});
    sample(correlation, state);
    EXPECT_TRUE(correlation.distributions().empty());
  }
  State row = empty_state(Box(1, 0.2, Edge::wall));
  add_disk(row, {0.2, 0.1}, {}, 0.1);
  add_disk(row, {0.7, 0.1}, {}, 0.1);
  PairCorrelation correlation(1, 5.0, 10);
  correlation.begin({row, {}});
  sample(correlation, row);
  EXPECT_TRUE(correlation.distributions().empty());
}

TEST(PairCorrelation, LeavesOutSamplesThatDoNotCount) {
  State const crowd = ideal_gas(Box(1, 1, Edge::periodic), 100, 0.05, 1);
  PairCorrelation correlation(1, 2.0, 10);
  correlation.begin({crowd, {}});
  sample(correlation, crowd, {}, false);
  EXPECT_TRUE(correlation.distributions().empty());
}

}  // namespace
}  // namespace gridlock
