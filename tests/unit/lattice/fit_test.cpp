#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "gridlock/lattice/start.hpp"
#include "reference/random_scene.hpp"

namespace {

using gridlock::Box;
using gridlock::Edge;
using gridlock::LatticeFit;
using gridlock::Vector;

/// The largest radius equal disks on these sites can have, from all pairs, walls and own images.
double largest_radius_by_brute_force(Box const& box, std::vector<Vector> const& sites) {
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      smallest = std::min(smallest, 0.5 * std::sqrt(squared_length(box.displacement(sites[i], sites[j]))));
    }
    if (!box.is_periodic_x()) smallest = std::min({smallest, sites[i].x, box.width() - sites[i].x});
    if (!box.is_periodic_y()) smallest = std::min({smallest, sites[i].y, box.height() - sites[i].y});
  }
  if (box.is_periodic_x()) smallest = std::min(smallest, 0.5 * box.width());
  return box.is_periodic_y() ? std::min(smallest, 0.5 * box.height()) : smallest;
}

std::vector<Vector> sites_of(LatticeFit const& fit) {
  std::vector<Vector> sites;
  for (std::uint64_t n = 0; n < fit.count; ++n) sites.push_back(fit.site(n));
  return sites;
}

TEST(SquareLattice, Of29By29DisksInAHardSquareBoxReachesPiOverFour) {
  LatticeFit const fit = fit_square_lattice(Box(1.0, 1.0, Edge::wall), 841);
  EXPECT_NEAR(fit.radius, 1.0 / 58.0, 1e-14);
  EXPECT_NEAR(fit.packing_fraction, std::numbers::pi / 4.0, 1e-12);
  EXPECT_EQ(fit.count, 841U);
  EXPECT_NEAR(fit.site(0).x, 0.5 / 29.0, 1e-15);
  EXPECT_NEAR(fit.site(30).y, 1.5 / 29.0, 1e-15);
}

// The optimum for 32 rows of 27 and 26 stretched to the box: with w = 1 − 2R, 2R is the smaller of w/26 and
// w √((1/52)² + (1/31)²) = 0.0375546 w, so 2R = 0.0375546/1.0375546 and φ = 841 π R².
TEST(TriangularLattice, StretchedToAHardSquareBoxReachesTheDerivedPackingFraction) {
  double const slant = std::sqrt(1.0 / (52.0 * 52.0) + 1.0 / (31.0 * 31.0));
  double const radius = 0.5 * slant / (1.0 + slant);
  LatticeFit const fit = fit_triangular_lattice(Box(1.0, 1.0, Edge::wall), 841);
  EXPECT_NEAR(fit.radius, radius, 1e-14);
  EXPECT_NEAR(fit.packing_fraction, 841.0 * std::numbers::pi * radius * radius, 1e-11);
  EXPECT_NEAR(fit.packing_fraction, 0.8654, 5e-5);  // the reference number, computed independently
}

TEST(TriangularLattice, InACommensuratePeriodicBoxReachesClosestPacking) {
  // 8 rows of 6: width 6 a, height 8 · a √3/2.
  Box const box(6.0, 8.0 * std::sqrt(0.75), Edge::periodic);
  LatticeFit const fit = fit_triangular_lattice(box, 48);
  EXPECT_NEAR(fit.packing_fraction, std::numbers::pi / std::sqrt(12.0), 1e-12);
}

TEST(EveryLattice, HasAsManySitesAsAskedForAndFitsWithTheRadiusItNames) {
  gridlock::reference::for_each_edges([](Edge edge_x, Edge edge_y) {
    for (auto const& [width, height] : {std::pair{1.0, 1.0}, {3.0, 1.0}, {0.7, 2.9}}) {
      Box const box(width, height, edge_x, edge_y);
      for (std::uint64_t count = 1; count <= 130; ++count) {
        for (auto const fit_lattice : {gridlock::fit_square_lattice, gridlock::fit_triangular_lattice}) {
          LatticeFit const fit = fit_lattice(box, count);
          ASSERT_EQ(fit.count, count);
          double const possible = largest_radius_by_brute_force(box, sites_of(fit));
          ASSERT_LE(fit.radius, possible) << count << " in " << width << " × " << height;
          ASSERT_GT(fit.radius, 0.0);
          // Where no site is left over, the radius named is all that is possible.
          bool const is_full_square = fit_lattice == gridlock::fit_square_lattice && width == height &&
                                      std::pow(std::round(std::sqrt(count)), 2) == static_cast<double>(count);
          if (!is_full_square) continue;
          ASSERT_NEAR(fit.radius, possible, 1e-13);
        }
      }
    }
  });
}

// Rows of 6 around the box, 8 of them between walls 7 · a √3/2 + a apart: the closest packing of such a channel.
TEST(TriangularLattice, InACommensurateChannelIsTheClosest) {
  double const width = 6.0;
  double const height = 7.0 * std::sqrt(0.75) + 1.0;
  for (Box const& box :
       {Box(width, height, Edge::periodic, Edge::wall), Box(height, width, Edge::wall, Edge::periodic)}) {
    LatticeFit const fit = fit_triangular_lattice(box, 48);
    EXPECT_NEAR(fit.radius, 0.5, 1e-12);
    EXPECT_EQ(fit.available, 48U);
  }
}

TEST(TriangularLattice, IsDenserThanTheSquareOneForManyDisksInAHardBox) {
  for (std::uint64_t const count : {841U, 5000U}) {
    Box const box(1.0, 1.0, Edge::wall);
    EXPECT_GT(fit_triangular_lattice(box, count).radius, fit_square_lattice(box, count).radius) << count;
  }
}

}  // namespace
