#include "gridlock/observe/defects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "gridlock/grid/voronoi.hpp"
#include "observe/defect_fractions.hpp"
#include "unit/analysis/lattices.hpp"
#include "unit/observe/hand_built.hpp"

namespace gridlock {
namespace {

Defects defects_of(Box const& box, RandomPoints const& points) {
  return find_defects(box, points.view(), find_voronoi_cells(box, points.view()).neighbours);
}

std::int32_t charge_of_all(Defects const& defects) {
  std::int32_t sum = 0;
  for (DefectCluster const& cluster : defects.clusters) sum += cluster.charge;
  return sum;
}

TEST(Defects, OfAPerfectLatticeAreNoneAlsoWithLittleNoise) {
  for (double const noise : {0.0, 0.05}) {
    NoisyLattice const lattice(noise);
    Defects const found = defects_of(lattice.box, lattice.points);
    EXPECT_EQ(found.points, 0U);
    EXPECT_TRUE(found.clusters.empty());
  }
}

TEST(Defects, OfALatticeWithNoiseAreAsManyAsInAnotherProgramAndWithoutCharge) {
  struct Known {
    double noise, share, error;
  };
  // Means over 700 such lattices by scipy.spatial.Delaunay.
  for (Known const& known : {Known{0.10, 0.00182, 0.00012}, Known{0.15, 0.0977, 0.0009}}) {
    MeanOfValues shares;
    for (unsigned seed = 1; seed <= 24; ++seed) {
      NoisyLattice const lattice(known.noise, seed);
      Defects const found = defects_of(lattice.box, lattice.points);
      EXPECT_EQ(charge_of_all(found), 0);
      shares.add(static_cast<double>(found.points) / static_cast<double>(lattice.view().count));
    }
    EXPECT_NEAR(shares.mean(), known.share, 4.0 * std::hypot(known.error, shares.error())) << known.noise;
  }
}

TEST(Defects, OfAVacancyAndOfAnInterstitialAreOneClusterOfTwoPairs) {
  for (bool const is_removed : {true, false}) {
    NoisyLattice lattice(1e-4);
    if (is_removed) {
      lattice.points.values.erase(lattice.points.values.begin() + 600, lattice.points.values.begin() + 602);
    } else {
      lattice.points.values.insert(lattice.points.values.end(), {12.62, 14.0 * std::sqrt(0.75) + 0.2});
    }
    Defects const found = defects_of(lattice.box, lattice.points);
    ASSERT_EQ(found.clusters.size(), 1U) << is_removed;
    EXPECT_EQ(found.clusters[0].kind, DefectKind::dislocation_pair);
    EXPECT_EQ(found.clusters[0].charge, 0);
    // Two 5 and two 7, or for a vacancy also two 5 and one 8.
    EXPECT_TRUE(found.points == 4 || (is_removed && found.points == 3)) << found.points;
    EXPECT_EQ(found.points_in(DefectKind::dislocation_pair), found.points);
  }
}

TEST(Defects, OfTwoCrystalsThatDifferByOneRowAreTwoOppositeDislocations) {
  // The lower rows have 20 points, the upper ones 21: at each of the two borders one row ends.
  RandomPoints points(0, 1.0, 1.0);
  double const step = std::sqrt(0.75);
  for (int row = 0; row < 20; ++row) {
    int const columns = row < 10 ? 20 : 21;
    for (int column = 0; column < columns; ++column) {
      double const x = (column + 0.5 * (row % 2) + 0.13) * 20.0 / columns;
      points.values.insert(points.values.end(), {x, (row + 0.5) * step});
    }
  }
  Defects const found = defects_of(Box(20.0, 20.0 * step, Edge::periodic), points);
  ASSERT_EQ(found.clusters.size(), 2U);
  for (DefectCluster const& cluster : found.clusters) {
    EXPECT_EQ(cluster.kind, DefectKind::dislocation);
    EXPECT_EQ(cluster.points, 2U);
    EXPECT_EQ(cluster.charge, 0);
    // The 5 is in the crystal with more columns, so that the Burgers vector is along the rows.
    EXPECT_NEAR(std::abs(cluster.moment.y), step, 1e-9);
    EXPECT_LT(std::abs(cluster.moment.x), 0.5);
  }
  EXPECT_LT(found.clusters[0].moment.y * found.clusters[1].moment.y, 0.0);
}

TEST(Defects, OfHandMadeListsAreToldApartByTheirCharges) {
  // Points 0 and 1 are a 5 and a 7 side by side, 2 a lone 5, 3 a lone 4, 4 and 5 two 5 side by side.
  std::vector<std::vector<std::uint32_t>> const lists{{1, 9, 9, 9, 9},
                                                      {0, 9, 9, 9, 9, 9, 9},
                                                      {9, 9, 9, 9, 9},
                                                      {9, 9, 9, 9},
                                                      {5, 9, 9, 9, 9},
                                                      {4, 9, 9, 9, 9},
                                                      {},
                                                      {},
                                                      {},
                                                      {0, 1, 2, 3, 4, 5}};
  NeighbourLists neighbours{.begin = {0}, .neighbours = {}};
  for (std::size_t i = 0; i < lists.size(); ++i) {
    // Points 6, 7 and 8 are left out as sixes.
    for (std::uint32_t const j : i >= 6 && i <= 8 ? std::vector<std::uint32_t>(6, 9) : lists[i])
      neighbours.neighbours.push_back(j);
    neighbours.begin.push_back(neighbours.neighbours.size());
  }
  RandomPoints const points(10, 1.0, 1.0);
  Defects const found = find_defects(Box(1.0, 1.0, Edge::periodic), points.view(), neighbours);
  EXPECT_EQ(found.points, 6U);
  EXPECT_EQ(found.points_in(DefectKind::dislocation), 2U);
  EXPECT_EQ(found.points_in(DefectKind::disclination), 1U);
  EXPECT_EQ(found.points_in(DefectKind::other), 3U);
  EXPECT_EQ(found.cluster[0], found.cluster[1]);
  EXPECT_EQ(found.cluster[9], Defects::none);
  EXPECT_EQ(found.clusters[found.cluster[2]].charge, 1);
  EXPECT_EQ(found.clusters[found.cluster[3]].charge, 2);
}

TEST(DefectFractions, AreTheSharesOfADirectSearch) {
  NoisyLattice const lattice(0.15);
  State state{.box = lattice.box, .agents = {}, .clock = {}, .seed = 0};
  for (std::size_t i = 0; i < lattice.view().count; ++i) hand_built::add_disk(state, lattice.points[i]);
  DefectFractions fractions(1);
  fractions.begin({state, {}});
  std::vector<double> const row = hand_built::sample(fractions, state);
  Defects const found = defects_of(lattice.box, lattice.points);
  auto const all = static_cast<double>(lattice.view().count);
  EXPECT_EQ(row[0], static_cast<double>(found.points) / all);
  EXPECT_EQ(row[3], static_cast<double>(found.points_in(DefectKind::dislocation_pair)) / all);
  EXPECT_GT(row[3], 0.0);
  EXPECT_NEAR(std::accumulate(row.begin() + 1, row.end(), 0.0), row[0], 1e-15);
  EXPECT_EQ(fractions.results().size(), 5U);
}

TEST(DefectFractions, AreRefusedBetweenWalls) {
  State const state = hand_built::ideal_gas(Box(1.0, 1.0, Edge::periodic, Edge::wall), 10, 0.01, 1);
  EXPECT_THROW(make_observables({.defects_every = 1}, {state, {}}), Error);
}

}  // namespace
}  // namespace gridlock
