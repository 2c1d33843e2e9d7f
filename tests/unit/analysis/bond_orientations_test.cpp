#include "gridlock/analysis/bond_orientations.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "gridlock/core/error.hpp"
#include "unit/analysis/lattices.hpp"

namespace gridlock {
namespace {

TEST(BondOrientations, LeaveOutThePointItself) {
  // In a box of few points a point can be its own neighbour, to which there is no direction.
  std::vector<double> const x{0.1, 0.6}, y{0.2, 0.3};
  NeighbourLists const neighbours{.begin = {0, 2, 3}, .neighbours = {0, 1, 1}};
  auto const orders =
      bond_orientations(Box(1.5, 1.0, Edge::periodic), {.x = x.data(), .y = y.data(), .count = 2}, neighbours);
  EXPECT_NEAR(std::abs(orders[0]), 1.0, 1e-12) << "one direction alone";
  EXPECT_EQ(std::abs(orders[1]), 0.0) << "none at all";
}

TEST(BondOrientations, OfARectangularLatticeWeightedByEdgesAreThoseOfTheSides) {
  // Two neighbours along x with edges of length b, two along y with edges of length a: ψ_2 = (b − a)/(b + a).
  constexpr double a = 1.0, b = 1.7;
  std::vector<double> x, y;
  for (int k = 0; k < 36; ++k) x.push_back(a * (k % 6)), y.push_back(b * (k / 6));
  PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 36};
  Box const box(6.0 * a, 6.0 * b, Edge::periodic);
  VoronoiCells const cells = find_voronoi_cells(box, points);
  for (unsigned const k : {1U, 2U, 3U, 4U, 6U}) {
    double const weighted = k == 4 ? 1.0 : k % 2 == 1 ? 0.0 : (b - a) / (b + a);
    double const plain = k == 4 ? 1.0 : 0.0;
    for (auto const& psi : bond_orientations(box, points, cells.neighbours, cells.edge_lengths, k))
      EXPECT_LT(std::abs(psi - weighted), 1e-12) << k;
    for (auto const& psi : bond_orientations(box, points, cells.neighbours, {}, k))
      EXPECT_LT(std::abs(psi - plain), 1e-12) << k;
  }
}

TEST(BondOrientations, WeightedByEdgesDoNotJumpWhereNeighboursComeAndGo) {
  // A square lattice has two neighbours more, along a diagonal, however little it is sheared.
  std::vector<double> x, y;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) x.push_back(column + 1e-6 * row), y.push_back(row);
  }
  PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 36};
  Box const box = Box(6.0, 6.0, Edge::periodic).shifted(6e-6);
  VoronoiCells const cells = find_voronoi_cells(box, points);
  for (auto const& psi : bond_orientations(box, points, cells.neighbours, {}, 4))
    EXPECT_NEAR(std::abs(psi), 1.0 / 3.0, 1e-5) << "(4 − 2)/6";
  for (auto const& psi : bond_orientations(box, points, cells.neighbours, cells.edge_lengths, 4))
    EXPECT_NEAR(std::abs(psi), 1.0, 1e-5);
}

TEST(BondOrientations, OfALatticeWithNoiseHaveTheExactMean) {
  struct Known {
    double noise, mean, local;
  };
  NeighbourLists const bonds = NoisyLattice::bonds();
  // The local order is of a simulation by another program, to about 1e-4.
  for (Known const& known : {Known{0.05, 0.91354000, 0.8509}, Known{0.10, 0.69376000, 0.5494}}) {
    MeanOfValues means, locals;
    for (unsigned seed = 1; seed <= 16; ++seed) {
      NoisyLattice const lattice(known.noise, seed);
      double mean = 0.0, local = 0.0;
      for (auto const& psi : bond_orientations(lattice.box, lattice.view(), bonds)) {
        mean += psi.real();
        local += std::norm(psi);
      }
      means.add(mean / static_cast<double>(lattice.view().count));
      locals.add(local / static_cast<double>(lattice.view().count));
    }
    EXPECT_NEAR(means.mean(), known.mean, 4.0 * means.error());
    EXPECT_NEAR(locals.mean(), known.local, 4.0 * locals.error() + 1e-4) << "⟨|ψ6|²⟩";
  }
}

TEST(BondOrientations, RefuseWeightsOfOtherNeighbours) {
  RandomPoints const points(20, 1.0, 1.0);
  Box const box(1.0, 1.0, Edge::periodic);
  VoronoiCells const cells = find_voronoi_cells(box, points.view());
  std::vector<double> const few(3, 1.0);
  EXPECT_THROW(bond_orientations(box, points.view(), cells.neighbours, few), Error);
  EXPECT_THROW(bond_orientations(box, points.view(), cells.neighbours, {}, 0), Error);
}

TEST(BondOrientations, OverVoronoiNeighboursAreOneInHexagonsAndZeroInSquares) {
  std::vector<double> x, y, square_x, square_y;
  for (int k = 0; k < 64; ++k) {
    x.push_back(k % 8 + 0.5 * (k / 8 % 2));
    y.push_back(k / 8 * std::sqrt(0.75));
    square_x.push_back(k % 8);
    square_y.push_back(k / 8);
  }
  PointsInMemory const hexagons{.x = x.data(), .y = y.data(), .count = 64};
  Box const box(8.0, 8.0 * std::sqrt(0.75), Edge::periodic);
  for (auto const& order : bond_orientations(box, hexagons, find_voronoi_cells(box, hexagons).neighbours)) {
    EXPECT_NEAR(std::abs(order), 1.0, 1e-12);
  }
  PointsInMemory const squares{.x = square_x.data(), .y = square_y.data(), .count = 64};
  Box const wide(8.0, 8.0, Edge::periodic);
  for (auto const& order : bond_orientations(wide, squares, find_voronoi_cells(wide, squares).neighbours)) {
    EXPECT_NEAR(std::abs(order), 0.0, 1e-12) << "exp(6 i θ) of four neighbours cancel";
  }
}

}  // namespace
}  // namespace gridlock
