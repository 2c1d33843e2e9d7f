#include "gridlock/analysis/pair_correlation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <vector>

#include "gridlock/analysis/bond_orientations.hpp"
#include "gridlock/core/error.hpp"
#include "unit/analysis/lattices.hpp"
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

/// Random complex numbers of magnitude up to `largest`.
std::vector<std::complex<double>> random_orders(std::size_t count, double largest) {
  RandomPoints const numbers(count, 1.0, 1.0, 77);
  std::vector<std::complex<double>> orders;
  for (std::size_t i = 0; i < count; ++i) orders.push_back(std::polar(largest * numbers[i].x, 6.0 * numbers[i].y));
  return orders;
}

TEST(PairCorrelations, OfOrdersAreTheMeansOverThePairsInAnyBoxAndForAnyNumberOfThreads) {
  std::vector<std::uint32_t> kinds(200);
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = i % 3 == 0 ? 1 : 0;
  for (double const shift : {0.0, 0.4}) {
    Box const box = Box(2.0, 1.0, Edge::periodic).shifted(shift);
    RandomPoints const points(200, 2.0, 1.0);
    for (double const largest : {1.0, 1e-7, 1e9}) {
      std::vector<std::complex<double>> const orders = random_orders(200, largest);
      PairCorrelations const found = find_pair_correlations(box, points.view(), 0.45, 5, kinds, 1, orders);
      EXPECT_EQ(find_pair_correlations(box, points.view(), 0.45, 5, kinds, 3, orders).order_correlation,
                found.order_correlation);
      EXPECT_EQ(find_pair_correlations(box, points.view(), 0.45, 5, kinds).g, found.g);
      std::vector<double> sums(20, 0.0), pairs(20, 0.0);
      for (std::size_t i = 0; i < 200; ++i) {
        for (std::size_t j = 0; j < 200; ++j) {
          double const r = std::sqrt(squared_length(box.displacement(points[i], points[j])));
          if (i == j || r >= 0.45) continue;
          std::size_t const bin = (kinds[i] * 2 + kinds[j]) * 5 + static_cast<std::size_t>(r / 0.09);
          sums[bin] += (std::conj(orders[i]) * orders[j]).real();
          pairs[bin] += 1.0;
        }
      }
      for (std::size_t k = 0; k < 20; ++k)
        EXPECT_NEAR(found.order_correlation[k], sums[k] / pairs[k], 1e-11 * largest * largest);
    }
  }
}

TEST(PairCorrelations, OfALatticeWithNoiseAreTheExactHexaticAndPositionalCorrelations) {
  struct Known {
    double noise, hexatic, positional;
  };
  NeighbourLists const bonds = NoisyLattice::bonds();
  double const g = 4.0 * std::numbers::pi / std::sqrt(3.0);
  for (Known const& known : {Known{0.05, 0.83455533, 0.87669623}, Known{0.10, 0.48130294, 0.59074023}}) {
    MeanOfValues hexatic, positional;
    for (unsigned seed = 1; seed <= 12; ++seed) {
      NoisyLattice const lattice(known.noise, seed);
      std::vector<std::complex<double>> waves;
      for (std::size_t i = 0; i < lattice.view().count; ++i) waves.push_back(std::polar(1.0, g * lattice.points[i].y));
      auto const psi = bond_orientations(lattice.box, lattice.view(), bonds);
      // One bin from 6 to 12 spacings, where disks share no neighbour.
      hexatic.add(find_pair_correlations(lattice.box, lattice.view(), 12.0, 2, {}, 1, psi).order_correlation[1]);
      positional.add(find_pair_correlations(lattice.box, lattice.view(), 12.0, 2, {}, 1, waves).order_correlation[1]);
    }
    EXPECT_NEAR(hexatic.mean(), known.hexatic, 4.0 * hexatic.error()) << known.noise;
    EXPECT_NEAR(positional.mean(), known.positional, 4.0 * positional.error()) << known.noise;
  }
}

TEST(PairCorrelationMap, CountsThePairsOfEachRectangleInATurnedFrame) {
  RandomPoints const points(200, 2.0, 1.0);
  std::vector<std::complex<double>> const orders = random_orders(200, 1.0);
  Vector const along{0.6, 0.8};
  for (double const shift : {0.0, 0.4}) {
    Box const box = Box(2.0, 1.0, Edge::periodic).shifted(shift);
    MapGrid const grid{.half = {0.35, 0.2}, .columns = 5, .rows = 3, .along = 2.0 * along};
    PairCorrelationMap const map = find_pair_correlation_map(box, points.view(), grid, orders, 2);
    std::vector<double> pairs(15, 0.0), sums(15, 0.0);
    for (std::size_t i = 0; i < 200; ++i) {
      for (std::size_t j = 0; j < 200; ++j) {
        Vector const d = box.displacement(points[i], points[j]);
        double const column = (dot(along, d) + 0.35) / 0.14;
        double const row = (along.x * d.y - along.y * d.x + 0.2) / (0.4 / 3.0);
        if (i == j || column < 0.0 || column >= 5.0 || row < 0.0 || row >= 3.0) continue;
        std::size_t const k = 5 * static_cast<std::size_t>(row) + static_cast<std::size_t>(column);
        pairs[k] += 1.0;
        sums[k] += (std::conj(orders[i]) * orders[j]).real();
      }
    }
    double const expected = 200.0 * 199.0 * 0.14 * (0.4 / 3.0) / box.area();
    for (std::size_t k = 0; k < 15; ++k) {
      EXPECT_NEAR(map.g[k], pairs[k] / expected, 1e-12) << k;
      EXPECT_NEAR(map.order_correlation[k], sums[k] / pairs[k], 1e-11) << k;
    }
    EXPECT_NEAR(map.x[0], -0.28, 1e-15);
    EXPECT_NEAR(map.y[2], 0.4 / 3.0, 1e-15);
  }
}

TEST(PairCorrelationMap, RefusesWhatHasNone) {
  RandomPoints const points(10, 1.0, 1.0);
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_THROW(find_pair_correlation_map(box, points.view(), {.half = {0.4, 0.4}, .columns = 2, .rows = 2}), Error)
      << "the corners are farther than half the box";
  EXPECT_THROW(find_pair_correlation_map(box, points.view(), {.half = {0.1, 0.0}}), Error);
  EXPECT_THROW(find_pair_correlation_map(box, points.view(), {.half = {0.1, 0.1}, .columns = 0}), Error);
  EXPECT_THROW(find_pair_correlation_map(box, points.view(), {.half = {0.1, 0.1}, .along = {}}), Error);
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
  std::vector<std::complex<double>> orders(9);
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 5, {}, 1, orders), Error);
  orders.emplace_back(0.0, std::nan(""));
  EXPECT_THROW(find_pair_correlations(box, points.view(), 0.3, 5, {}, 1, orders), Error);
  RandomPoints broken = points;
  broken.values[3] = std::nan("");
  EXPECT_THROW(find_pair_correlations(box, broken.view(), 0.3, 5), Error);
}

}  // namespace
}  // namespace gridlock
