#include "gridlock/analysis/spectral_density.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/analysis/points.hpp"

namespace gridlock {
namespace {

double area_of_wave(double radius, double q) { return 2.0 * std::numbers::pi * radius * ::j1(q * radius) / q; }

TEST(SpectralDensity, OfOneDiskIsTheSquareOfItsFormFactor) {
  std::vector<double> const x{0.3}, y{1.7}, radius{0.2};
  PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 1};
  double const q = 2.0 * std::numbers::pi / 3.0;
  SpectralDensity const found = find_spectral_density(Box(3.0, 2.0, Edge::periodic), points, radius, 1.001 * q, 1);
  ASSERT_EQ(found.vectors, std::vector<std::uint64_t>{1}) << "(1, 0) alone";
  EXPECT_NEAR(found.wave_number[0], q, 1e-14);
  EXPECT_NEAR(found.density[0], area_of_wave(0.2, q) * area_of_wave(0.2, q) / 6.0, 1e-15);
}

TEST(SpectralDensity, OfALatticeVanishesButAtItsWaves) {
  std::vector<double> x, y;
  for (int k = 0; k < 64; ++k) {
    x.push_back(k % 8);
    y.push_back(k / 8);
  }
  std::vector<double> const radius(64, 0.5);
  PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 64};
  double const wave = 2.0 * std::numbers::pi;
  SpectralDensity const found = find_spectral_density(Box(8.0, 8.0, Edge::periodic), points, radius, 1.01 * wave, 200);
  for (std::size_t k = 0; k < found.density.size() && found.wave_number[k] < 0.99 * wave; ++k) {
    EXPECT_NEAR(found.density[k], 0.0, 1e-20);
  }
  // (1, 0) and (0, 1) of the lattice, and nothing from the others.
  double const expected = 64.0 * area_of_wave(0.5, wave) * area_of_wave(0.5, wave);
  double total = 0.0;
  for (std::size_t k = 0; k < found.density.size(); ++k)
    total += found.density[k] * static_cast<double>(found.vectors[k]);
  EXPECT_NEAR(total, 2.0 * expected, 1e-9);
}

TEST(SpectralDensity, HasAllWavesOfWideAndOfTallBoxes) {
  std::vector<double> const x{0.3, 0.6}, y{1.7, 0.2}, radius{0.2, 0.1};
  PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 2};
  for (Box const& box : {Box(5.0, 2.0, Edge::periodic), Box(2.0, 5.0, Edge::periodic)}) {
    double const largest = 14.3;
    std::uint64_t expected = 0;
    for (int m = -40; m <= 40; ++m) {
      for (int n = -40; n <= 40; ++n) {
        double const length = 2.0 * std::numbers::pi * std::hypot(m / box.width(), n / box.height());
        if (length > 0.0 && length <= largest) ++expected;
      }
    }
    SpectralDensity const found = find_spectral_density(box, points, radius, largest, 7);
    std::uint64_t sum = 0;
    for (std::uint64_t const vectors : found.vectors) sum += vectors;
    EXPECT_EQ(2 * sum, expected) << "one of every two opposite vectors";
  }
}

TEST(SpectralDensity, OfWideAndTallBoxesIsTheSumOfItsDefinition) {
  std::vector<double> const radius{0.2, 0.1, 0.2, 0.15, 0.1};
  for (Box const& box : {Box(5.0, 2.0, Edge::periodic), Box(2.0, 5.0, Edge::periodic)}) {
    RandomPoints const points(5, box.width(), box.height());
    double const largest = 9.0;
    double expected = 0.0;
    double vectors = 0.0;
    for (int m = -20; m <= 20; ++m) {
      for (int n = -20; n <= 20; ++n) {
        Vector const q{2.0 * std::numbers::pi * m / box.width(), 2.0 * std::numbers::pi * n / box.height()};
        double const length = std::sqrt(squared_length(q));
        if (!(length > 0.0) || length > largest) continue;
        double real = 0.0;
        double imaginary = 0.0;
        for (std::size_t i = 0; i < 5; ++i) {
          double const phase = q.x * points[i].x + q.y * points[i].y;
          real += area_of_wave(radius[i], length) * std::cos(phase);
          imaginary += area_of_wave(radius[i], length) * std::sin(phase);
        }
        expected += (real * real + imaginary * imaginary) / box.area();
        vectors += 1.0;
      }
    }
    SpectralDensity const found = find_spectral_density(box, points.view(), radius, largest, 1);
    EXPECT_NEAR(found.density[0], expected / vectors, 1e-10 * expected / vectors);
  }
}

TEST(SpectralDensity, OfDisksAtRandomIsThatOfAnIdealGasForAnyThreads) {
  Box const box(1.0, 2.0, Edge::periodic);
  RandomPoints const points(500, 1.0, 2.0);
  std::vector<double> radius;
  for (int k = 0; k < 500; ++k) radius.push_back(0.01 + 2e-5 * k);
  SpectralDensity const found = find_spectral_density(box, points.view(), radius, 200.0, 5);
  for (std::size_t ring = 0; ring < found.density.size(); ++ring) {
    double expected = 0.0;
    for (double const r : radius) expected += std::pow(area_of_wave(r, found.wave_number[ring]), 2) / box.area();
    EXPECT_NEAR(found.density[ring] / expected, 1.0, 5.0 / std::sqrt(static_cast<double>(found.vectors[ring])));
  }
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(find_spectral_density(box, points.view(), radius, 200.0, 5, threads).density, found.density);
  }
}

std::string error_of(Box const& box, std::vector<double> const& radii, double largest, std::size_t bins) {
  std::vector<double> const x{0.5}, y{0.5};
  try {
    find_spectral_density(box, {.x = x.data(), .y = y.data(), .count = 1}, radii, largest, bins);
  } catch (Error const& error) {
    return error.problems().front().what;
  }
  return "";
}

TEST(SpectralDensity, RefusesWhatHasNone) {
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_EQ(error_of(Box(1.0, 1.0, Edge::wall), {0.1}, 1.0, 1),
            "the spectral density needs a box that is periodic in x and y");
  EXPECT_EQ(error_of(box, {}, 1.0, 1), "there are 0 radii for 1 disks");
  EXPECT_EQ(error_of(box, {0.0}, 1.0, 1), "a radius is 0");
  EXPECT_EQ(error_of(box, {0.1}, -1.0, 1), "the largest wave number is -1");
  EXPECT_EQ(error_of(box, {0.1}, 1.0, 0), "the spectral density has 0 bins");
  EXPECT_NE(error_of(box, {0.1}, 1e6, 1).find("wave vectors are shorter than"), std::string::npos);
  EXPECT_EQ(error_of(box, {0.1}, 1.0, 1), "");
}

}  // namespace
}  // namespace gridlock
