#include "gridlock/analysis/structure_peak.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "unit/analysis/lattices.hpp"

namespace gridlock {
namespace {

TEST(StructurePeak, OfALatticeWithNoiseHasTheExactHeight) {
  struct Known {
    double noise, bragg;
  };
  double const g = 4.0 * std::numbers::pi / std::sqrt(3.0);
  for (Known const& known : {Known{0.05, 0.87669623}, Known{0.10, 0.59074023}}) {
    MeanOfValues heights;
    for (unsigned seed = 1; seed <= 16; ++seed) {
      NoisyLattice const lattice(known.noise, seed);
      StructurePeak const peak = find_structure_peak(lattice.box, lattice.view(), {0.1, 1.05 * g}, 1.0);
      EXPECT_NEAR(peak.at.x, 0.0, 1e-12);
      EXPECT_NEAR(peak.at.y, g, 1e-12);
      heights.add(peak.height);
    }
    double const exact = known.bragg + (1.0 - known.bragg) / (NoisyLattice::columns * NoisyLattice::rows);
    EXPECT_NEAR(heights.mean(), exact, 4.0 * heights.error()) << known.noise;
  }
}

TEST(StructurePeak, HasTheWaveVectorsOfAnObliqueBoxAndTheDirectSums) {
  Box const box = Box(2.0, 1.0, Edge::periodic).shifted(0.3);
  RandomPoints const points(30, 2.0, 1.0);
  StructurePeak const found = find_structure_peak(box, points.view(), {5.0, -7.0}, 20.0, 2);
  // About one wave vector in (2π)²/A.
  EXPECT_NEAR(static_cast<double>(found.wave_vectors.size()), 1600.0 * box.area() / 39.478, 12.0);
  for (std::size_t k = 0; k < found.wave_vectors.size(); ++k) {
    Vector const q = found.wave_vectors[k];
    for (Vector const period : {Vector{2.0, 0.0}, Vector{0.3, 1.0}}) {
      double const turns = dot(q, period) / (2.0 * std::numbers::pi);
      EXPECT_NEAR(turns, std::round(turns), 1e-9);
    }
    std::complex<double> sum;
    for (std::size_t i = 0; i < 30; ++i) sum += std::polar(1.0, dot(q, points[i]));
    EXPECT_NEAR(found.structure_factor[k], std::norm(sum) / 30.0, 1e-9);
  }
  EXPECT_EQ(find_structure_peak(box, points.view(), {5.0, -7.0}, 20.0, 1).structure_factor, found.structure_factor);
}

TEST(StructurePeak, RefusesWhatHasNone) {
  RandomPoints const points(10, 1.0, 1.0);
  Box const box(1.0, 1.0, Edge::periodic);
  EXPECT_THROW(find_structure_peak(Box(1.0, 1.0, Edge::wall), points.view(), {6.0, 0.0}, 3.0), Error);
  EXPECT_THROW(find_structure_peak(box, {}, {6.0, 0.0}, 3.0), Error);
  EXPECT_THROW(find_structure_peak(box, points.view(), {3.0, 3.0}, 0.5), Error) << "between wave vectors";
  EXPECT_THROW(find_structure_peak(box, points.view(), {0.0, 0.0}, 0.5), Error) << "q = 0 alone";
  EXPECT_THROW(find_structure_peak(box, points.view(), {0.0, 0.0}, 1e6), Error);
  EXPECT_THROW(find_structure_peak(box, points.view(), {0.0, std::nan("")}, 3.0), Error);
}

}  // namespace
}  // namespace gridlock
