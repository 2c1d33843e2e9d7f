#include "gridlock/analysis/pair_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/analysis/points.hpp"

namespace gridlock {
namespace {

/// g of two kinds by a look at every pair.
std::vector<double> direct(Box const& box, RandomPoints const& points, std::vector<std::uint32_t> const& kinds,
                           std::uint32_t a, std::uint32_t b, double range, std::size_t bins) {
  std::vector<double> counts(bins, 0.0);
  double pairs = 0.0;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      bool const is_wanted = (kinds[i] == a && kinds[j] == b) || (kinds[i] == b && kinds[j] == a);
      if (!is_wanted) continue;
      pairs += 1.0;
      double const r = std::sqrt(squared_length(box.displacement(points[i], points[j])));
      if (r < range) counts[static_cast<std::size_t>(r / range * static_cast<double>(bins))] += 1.0;
    }
  }
  double const width = range / static_cast<double>(bins);
  for (std::size_t k = 0; k < bins; ++k) {
    double const inner = static_cast<double>(k) * width;
    double const ring = std::numbers::pi * ((inner + width) * (inner + width) - inner * inner);
    counts[k] /= pairs * ring / box.area();
  }
  return counts;
}

TEST(PairCorrelations, AreThoseOfAllPairsForAnyRangeAndNumberOfThreads) {
  Box const box(2.0, 1.0, Edge::periodic);
  RandomPoints const points(300, 2.0, 1.0);
  std::vector<std::uint32_t> kinds(300);
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = i % 5 == 0 ? 1 : 0;
  for (double const range : {0.03, 0.2, 0.5}) {
    PairCorrelations const found = find_pair_correlations(box, points.view(), range, 7, kinds);
    EXPECT_EQ(find_pair_correlations(box, points.view(), range, 7, kinds, 3).g, found.g);
    for (std::uint32_t a = 0; a < 2; ++a) {
      for (std::uint32_t b = 0; b < 2; ++b) {
        std::vector<double> const expected = direct(box, points, kinds, a, b, range, 7);
        for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(found.of(a, b)[k], expected[k], 1e-12 * (1.0 + expected[k]));
      }
    }
  }
}

TEST(PairCorrelations, OfPointsOutsideAPeriodicBoxAreThoseOfTheirImages) {
  Box const box(1.0, 1.0, Edge::periodic);
  RandomPoints const points(100, 1.0, 1.0);
  RandomPoints moved = points;
  for (std::size_t i = 0; i < 100; ++i) moved.values[2 * i] += static_cast<double>(i % 3) - 1.0;
  auto const here = find_pair_correlations(box, points.view(), 0.3, 5).g;
  auto const there = find_pair_correlations(box, moved.view(), 0.3, 5).g;
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(here[k], there[k], 1e-12);
}

TEST(PairCorrelations, WithoutPairsAreNoNumbers) {
  RandomPoints const one(1, 1.0, 1.0);
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_TRUE(std::isnan(find_pair_correlations(box, one.view(), 0.3, 2).g[0]));
}

TEST(PairCorrelations, RefuseWhatHasNone) {
  RandomPoints const points(10, 1.0, 1.0);
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_THROW(find_pair_correlations(Box(1.0, 1.0, Edge::wall), points.view(), 0.3, 5), Error);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.6, 5), Error);
  EXPECT_THROW(find_pair_correlations(box, points.view(), -0.1, 5), Error);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 0), Error);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 20'000'000), Error);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 5, std::vector<std::uint32_t>{0, 1}), Error);
  std::vector<std::uint32_t> const far(10, 4'000'000'000);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 5, far), Error);
  RandomPoints broken = points;
  broken.values[3] = std::nan("");
  EXPECT_THROW(find_pair_correlations(box, broken.view(), 0.3, 5), Error);
}

}  // namespace
}  // namespace gridlock
