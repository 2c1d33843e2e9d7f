#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "gridlock/analysis/collective_scattering.hpp"
#include "gridlock/analysis/pair_correlation.hpp"
#include "gridlock/analysis/van_hove.hpp"
#include "gridlock/core/error.hpp"
#include "unit/analysis/random_walk.hpp"

namespace gridlock {
namespace {

/// Independent walkers that start anywhere in a square of side 20.
RandomWalk scattered_walk(std::size_t frames, std::size_t agents) {
  RandomWalk walk(frames, agents);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(0.0, 20.0);
  for (std::size_t k = 0; k < 2 * agents; ++k) {
    double const start = place(random);
    for (std::size_t f = 0; f < frames; ++f) walk.positions[2 * f * agents + k] += start;
  }
  return walk;
}

std::vector<std::uint32_t> two_kinds(std::size_t agents) {
  std::vector<std::uint32_t> kinds(agents);
  for (std::size_t i = 0; i < agents; ++i) kinds[i] = i % 3 == 0 ? 1 : 0;
  return kinds;
}

TEST(CollectiveScattering, IsThatOfTheDefinitionAlsoInAnObliqueBox) {
  constexpr std::size_t frames = 7;
  constexpr std::size_t agents = 83;  // more than a block, and no multiple of the lanes
  RandomWalk const walk = scattered_walk(frames, agents);
  std::vector<std::uint32_t> const kinds = two_kinds(agents);
  TrajectoryInMemory mixture = walk.view();
  mixture.kinds = kinds;
  Box const box = Box(20.0, 16.0, Edge::periodic).tilted(0.2);
  CollectiveScattering const found =
      find_collective_scattering(box, mixture, {.wave_number = 1.6, .width = 0.4, .threads = 2});
  // The vectors q with q·a and q·b multiples of 2π for the sides a and b of the oblique box.
  std::vector<Vector> vectors;
  for (int n = 0; n <= 10; ++n) {
    for (int m = -20; m <= 20; ++m) {
      if (n == 0 && m <= 0) continue;
      double const x = 2.0 * std::numbers::pi * n / 20.0;
      Vector const q{x, (2.0 * std::numbers::pi * m - x * box.shift()) / 16.0};
      if (double const length = std::hypot(q.x, q.y); length >= 1.4 && length <= 1.8) vectors.push_back(q);
    }
  }
  EXPECT_EQ(found.vectors, vectors.size());
  auto const wave = [&](Vector q, std::size_t frame, std::size_t kind) {
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < agents; ++i) {
      double const* const r = walk.positions.data() + 2 * (frame * agents + i);
      if (kinds[i] == kind) sum += std::polar(1.0, q.x * r[0] + q.y * r[1]);
    }
    return sum;
  };
  double const sizes[] = {55.0, 28.0};
  for (std::size_t const lag : {0UL, 1UL, 4UL}) {
    EXPECT_EQ(found.origins[lag], frames - lag);
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t b = 0; b < 2; ++b) {
        double sum = 0.0;
        for (Vector const q : vectors) {
          for (std::size_t from = 0; from + lag < frames; ++from) {
            sum += 0.5 * (wave(q, from + lag, a) * std::conj(wave(q, from, b)) +
                          wave(q, from + lag, b) * std::conj(wave(q, from, a)))
                             .real();
          }
        }
        double const exact =
            sum / (std::sqrt(sizes[a] * sizes[b]) * static_cast<double>(vectors.size() * (frames - lag)));
        EXPECT_NEAR(found.of(a, b)[lag].value, exact, 1e-11);
      }
    }
  }
}

TEST(CollectiveScattering, OfIndependentWalkersDecaysAsThatOfEachAndKindsKnowNothingOfEachOther) {
  RandomWalk const walk = scattered_walk(300, 60);
  std::vector<std::uint32_t> const kinds = two_kinds(60);
  TrajectoryInMemory mixture = walk.view();
  mixture.kinds = kinds;
  CollectiveScattering const found =
      find_collective_scattering(Box(20.0, 20.0, Edge::periodic), mixture, {.wave_number = 1.0, .width = 0.2});
  double const q = found.wave_number;
  EXPECT_NEAR(q, 1.0, 0.05);
  for (std::size_t const lag : {1UL, 3UL, 20UL}) {
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t b = 0; b < 2; ++b) {
        double const exact = a == b ? std::exp(-0.5 * q * q * static_cast<double>(lag)) : 0.0;
        Estimate const& estimate = found.of(a, b)[lag];
        EXPECT_LT(std::abs(estimate.value - exact), 4.0 * estimate.error.value()) << lag << a << b;
      }
    }
  }
}

TEST(CollectiveScattering, RefusesRingsWithoutWavesAndWalls) {
  RandomWalk const walk(4, 3);
  Box const box(20.0, 20.0, Edge::periodic);
  EXPECT_THROW(find_collective_scattering(box, walk.view(), {.wave_number = 0.1, .width = 0.01}), Error);
  EXPECT_THROW(find_collective_scattering(box, walk.view(), {.wave_number = 0.0, .width = 0.1}), Error);
  EXPECT_THROW(find_collective_scattering(box, walk.view(), {.wave_number = 1.0, .width = -0.1}), Error);
  EXPECT_THROW(find_collective_scattering(box, walk.view(), {.wave_number = 1e6, .width = 0.1}), Error);
  EXPECT_THROW(find_collective_scattering(Box(20.0, 20.0, Edge::wall), walk.view(), {.wave_number = 1.0, .width = 0.2}),
               Error);
}

TEST(VanHove, IsThatOfTheDefinition) {
  constexpr std::size_t frames = 5;
  constexpr std::size_t agents = 40;
  RandomWalk const walk = scattered_walk(frames, agents);
  std::vector<std::uint32_t> const kinds = two_kinds(agents);
  TrajectoryInMemory mixture = walk.view();
  mixture.kinds = kinds;
  Box const box = Box(20.0, 20.0, Edge::periodic).tilted(0.1);
  VanHove const found = find_van_hove(mixture, {.lags = {2.0}, .range = 8.0, .bins = 4, .box = box, .threads = 2});
  double const sizes[] = {26.0, 14.0};
  std::vector<double> self(8), distinct(16);
  for (std::size_t from = 0; from + 2 < frames; ++from) {
    for (std::size_t i = 0; i < agents; ++i) {
      for (std::size_t j = 0; j < agents; ++j) {
        double const* const before = walk.positions.data() + 2 * (from * agents + i);
        double const* const after = walk.positions.data() + 2 * ((from + 2) * agents + j);
        Vector const moved = i == j ? Vector{after[0] - before[0], after[1] - before[1]}
                                    : box.displacement({before[0], before[1]}, {after[0], after[1]});
        auto const bin = static_cast<std::size_t>(std::hypot(moved.x, moved.y) / 2.0);
        if (bin >= 4) continue;
        double const ring = std::numbers::pi * 4.0 * static_cast<double>(2 * bin + 1);
        std::size_t const a = kinds[i], b = kinds[j];
        if (i == j) self[4 * a + bin] += 1.0 / (3.0 * sizes[a] * ring);
        if (i != j)
          distinct[4 * (2 * a + b) + bin] += 400.0 / (3.0 * ring * sizes[a] * (sizes[b] - (a == b ? 1.0 : 0.0)));
      }
    }
  }
  ASSERT_EQ(found.lags[0].lag, 2.0);
  ASSERT_EQ(found.lags[0].origins, 3U);
  for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(found.lags[0].self[k].value, self[k], 1e-14) << k;
  for (std::size_t k = 0; k < 16; ++k) EXPECT_NEAR(found.lags[0].distinct[k].value, distinct[k], 1e-12) << k;
}

TEST(VanHove, WithoutTimeIsThePairCorrelationAndNobodyHasMoved) {
  RandomWalk const walk = scattered_walk(2, 300);
  Box const box(20.0, 20.0, Edge::periodic);
  VanHove const found = find_van_hove(walk.view(), {.lags = {0.0}, .range = 5.0, .bins = 10, .box = box});
  for (std::size_t k = 0; k < 10; ++k) {
    double g = 0.0;
    for (std::size_t frame = 0; frame < 2; ++frame) {
      double const* const first = walk.positions.data() + 600 * frame;
      PointsInMemory const points{.x = first, .y = first + 1, .count = 300, .stride = 2};
      g += 0.5 * find_pair_correlations(box, points, 5.0, 10).g[k];
    }
    EXPECT_NEAR(found.lags[0].distinct[k].value, g, 1e-12);
    EXPECT_NEAR(found.lags[0].self[k].value, k == 0 ? 4.0 / std::numbers::pi : 0.0, 1e-12);
  }
}

TEST(VanHove, OfIndependentWalkersIsAGaussianAndOthersAreAnywhere) {
  RandomWalk const walk = scattered_walk(200, 100);
  VanHove const found = find_van_hove(
      walk.view(),
      {.lags = {1.0, 4.0}, .range = 6.0, .bins = 12, .box = Box(20.0, 20.0, Edge::periodic), .max_origins = 60});
  for (VanHoveAtLag const& at : found.lags) {
    EXPECT_EQ(at.origins, 60U);
    EXPECT_LT(at.independent_origins, 61U);
    for (std::size_t k = 0; k < 12; ++k) {
      auto const beyond = [&](double r) { return std::exp(-r * r / (2.0 * at.lag)); };  // 4 D t = 2 t
      double const inner = 0.5 * static_cast<double>(k);
      double const exact =
          (beyond(inner) - beyond(inner + 0.5)) / (std::numbers::pi * (std::pow(inner + 0.5, 2) - inner * inner));
      auto const expect = [&](Estimate const& estimate, double value) {
        if (estimate.error.value() > 0.0) {
          EXPECT_LT(std::abs(estimate.value - value), 4.5 * estimate.error.value()) << at.lag << " " << k;
        }
      };
      if (exact > 1e-4) expect(at.self[k], exact);
      expect(at.distinct[k], 1.0);
    }
  }
}

TEST(VanHove, RefusesBoxesThatAreTooSmallAndLagsBelowZero) {
  RandomWalk const walk(4, 3);
  Box const box(20.0, 20.0, Edge::periodic);
  EXPECT_THROW(find_van_hove(walk.view(), {.lags = {1.0}, .range = 11.0, .box = box}), Error);
  EXPECT_THROW(find_van_hove(walk.view(), {.lags = {1.0}, .range = 2.0, .box = Box(20.0, 20.0, Edge::wall)}), Error);
  EXPECT_THROW(find_van_hove(walk.view(), {.lags = {-1.0}, .range = 2.0}), Error);
  EXPECT_THROW(find_van_hove(walk.view(), {.lags = {1.0}, .range = 0.0}), Error);
  EXPECT_THROW(find_van_hove(walk.view(), {.lags = {1.0}, .range = 2.0, .bins = 0}), Error);
}

}  // namespace
}  // namespace gridlock
