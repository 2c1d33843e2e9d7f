// Oblique boxes: against brute force over images, and against a rectangle that holds two of them. Where the shift is half
// the width, two oblique boxes above one another have a shift of one width together, which is a rectangle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "gridlock/analysis/bond_orientations.hpp"
#include "gridlock/analysis/pair_correlation.hpp"
#include "gridlock/analysis/spectral_density.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/neighbour_search.hpp"
#include "gridlock/grid/voronoi.hpp"
#include "gridlock/observe/pairs.hpp"

namespace gridlock {
namespace {

using Pairs = std::set<std::pair<std::size_t, std::size_t>>;

struct Points {
  std::vector<double> x, y;
  [[nodiscard]] PointsInMemory in_memory() const { return {.x = x.data(), .y = y.data(), .count = x.size()}; }
  [[nodiscard]] Vector operator[](std::size_t i) const { return {x[i], y[i]}; }
};

/// Returns random points; some lie outside the box, which means their image inside.
Points random_points(Box const& box, std::size_t count, std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    bool const is_outside = i % 7 == 0;
    points.x.push_back(box.width() * (is_outside ? 5.0 * random.uniform() - 2.0 : random.uniform()));
    points.y.push_back(box.height() * (is_outside ? 5.0 * random.uniform() - 2.0 : random.uniform()));
  }
  return points;
}

/// Returns the shortest vector from one point to any image of another, by trying all images that can be the nearest.
Vector shortest(Box const& box, Vector from, Vector to) {
  Vector best{1e300, 0.0};
  for (int m = -5; m <= 5; ++m) {
    for (int n = -9; n <= 9; ++n) {
      Vector const d = to - from + Vector{n * box.width() + m * box.shift(), m * box.height()};
      if (squared_length(d) < squared_length(best)) best = d;
    }
  }
  return best;
}

Box random_box(std::uint64_t seed) {
  RandomStream random(seed, 1, 0, Purpose::start_position);
  Box const rectangle(0.5 + random.uniform(), 0.5 + random.uniform(), Edge::periodic);
  return rectangle.tilted(8.0 * random.uniform() - 4.0);
}

TEST(ObliqueBox, KeepsTheTiltBetweenHalfABoxToEachSide) {
  Box const box(2.0, 4.0, Edge::periodic);
  EXPECT_EQ(box.tilted(0.125).shift(), 0.5);
  EXPECT_EQ(box.tilted(0.125).tilt(), 0.125);
  EXPECT_EQ(box.tilted(0.375).shift(), -0.5);  // 1.5 to the right is 0.5 to the left
  EXPECT_EQ(box.widths_in(1.5), 1.0);
  EXPECT_EQ(box.tilted(0.5), box);
  EXPECT_FALSE(box.tilted(5.0).is_oblique());
  EXPECT_THROW(static_cast<void>(Box(1.0, 1.0, Edge::wall).tilted(0.1)), Error);
  EXPECT_THROW(static_cast<void>(Box(1.0, 1.0, Edge::periodic, Edge::wall).tilted(0.1)), Error);
  EXPECT_THROW(static_cast<void>(box.tilted(std::nan(""))), Error);
  EXPECT_THROW(static_cast<void>(box.tilted(1e20)), Error) << "its rest has no digits";
  EXPECT_EQ(Box(1.0, 1.0, Edge::wall).tilted(0.0), Box(1.0, 1.0, Edge::wall));
}

TEST(ObliqueBox, DisplacementsAreTheShortestBelowHalfASideAndAntisymmetric) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Box const box = random_box(seed);
    Points const points = random_points(box, 20, seed);
    for (std::size_t i = 1; i < points.x.size(); ++i) {
      Vector const from = box.inside(points[i - 1]);
      Vector const to = points[i];
      Vector const d = box.displacement(from, to);
      Vector const back = box.displacement(to, from);
      ASSERT_EQ(d, -1.0 * back);
      Vector const best = shortest(box, from, box.inside(to));
      if (std::sqrt(squared_length(best)) > 0.499 * box.shortest_period()) continue;
      ASSERT_NEAR(d.x, best.x, 1e-12) << seed;
      ASSERT_NEAR(d.y, best.y, 1e-12) << seed;
    }
  }
}

TEST(ObliqueBox, WrapsAPointToItsImageAndCountsTheEdges) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Box const box = random_box(seed);
    RandomStream random(seed, 2, 0, Purpose::start_position);
    Vector const p{(1.8 * random.uniform() - 0.4) * box.width(), (1.8 * random.uniform() - 0.4) * box.height()};
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const wrapped = box.wrap(p, crossed_x, crossed_y);
    EXPECT_TRUE(wrapped.y >= 0.0 && wrapped.y < box.height());
    EXPECT_TRUE(wrapped.x >= 0.0 && wrapped.x < box.width());
    Vector const again = wrapped + box.offset_of_image(crossed_x, crossed_y);
    EXPECT_NEAR(again.x, p.x, 1e-12);
    EXPECT_NEAR(again.y, p.y, 1e-12);
    EXPECT_NEAR(squared_length(box.displacement(wrapped, box.inside(p))), 0.0, 1e-20);
  }
}

Pairs brute_force(Box const& box, Points const& points, double cutoff) {
  Pairs pairs;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Vector const d = shortest(box, box.inside(points[i]), box.inside(points[j]));
      if (squared_length(d) < cutoff * cutoff) pairs.emplace(i, j);
    }
  }
  return pairs;
}

Pairs pairs_of(PointPairs const& found) {
  Pairs pairs;
  for (std::size_t k = 0; k < found.size(); ++k) {
    std::size_t const i = found.first()[k];
    std::size_t const j = found.second()[k];
    EXPECT_TRUE(pairs.emplace(std::max(i, j), std::min(i, j)).second) << "a pair is found twice";
  }
  return pairs;
}

TEST(ObliqueBox, PairsAreThoseOfBruteForceInEverySearch) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Box const box = random_box(seed);
    Points const points = random_points(box, 3 + 2 * seed, seed);
    double const cutoff = box.shortest_period() * (seed % 5 == 0 ? 0.5 : 0.03 + 0.007 * static_cast<double>(seed));
    Pairs const expected = brute_force(box, points, cutoff);
    EXPECT_EQ(pairs_of(find_pairs(box, cutoff, points.in_memory(), 1 + seed % 3)), expected) << seed;

    NeighbourSearch const search(box, cutoff, points.x, points.y);
    Pairs of_search;
    search.for_each_pair([&](std::size_t i, std::size_t j, Vector separation) {
      EXPECT_GT(i, j);
      EXPECT_EQ(separation, box.displacement(points[i], points[j]));
      EXPECT_TRUE(of_search.emplace(i, j).second);
    });
    EXPECT_EQ(of_search, expected) << seed;

    NeighbourLists const lists = find_neighbour_lists(box, cutoff, points.in_memory());
    Pairs of_lists, of_neighbours;
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      for (std::uint64_t k = lists.begin[i]; k < lists.begin[i + 1]; ++k) {
        std::size_t const j = lists.neighbours[k];
        of_lists.emplace(std::max(i, j), std::min(i, j));
      }
      std::size_t neighbours = 0;
      search.for_each_neighbour(i, [&](std::size_t j, Vector) {
        of_neighbours.emplace(std::max(i, j), std::min(i, j));
        ++neighbours;
      });
      EXPECT_EQ(neighbours, lists.begin[i + 1] - lists.begin[i]);
    }
    EXPECT_EQ(of_lists, expected) << seed;
    EXPECT_EQ(of_neighbours, expected) << seed;
  }
}

TEST(ObliqueBox, PairsOfDisksOfManySizesAreThoseOfBruteForce) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Box const box = random_box(seed);
    Points const points = random_points(box, 150, seed);
    RandomStream random(seed, 3, 0, Purpose::start_position);
    std::vector<double> radius;
    for (std::size_t i = 0; i < points.x.size(); ++i)
      radius.push_back(box.shortest_period() * (i % 50 == 0 ? 0.2 : 0.002 + 0.02 * random.uniform()));
    Pairs expected;
    for (auto const& [i, j] : brute_force(box, points, 0.5 * box.shortest_period())) {
      double const contact = 1.1 * (radius[i] + radius[j]);
      Vector const d = box.displacement(points[i], points[j]);
      if (squared_length(d) < contact * contact) expected.emplace(i, j);
    }
    EXPECT_EQ(pairs_of(find_pairs_of_disks(box, {.factor = 1.1}, points.in_memory(), radius)), expected) << seed;
  }
}

/// Two boxes of points above one another, and the same disks in one of them.
struct Doubled {
  Box box = Box(1.0, 1.0, Edge::periodic).shifted(0.5);
  Box rectangle{1.0, 2.0, Edge::periodic};
  Points points;
  Points twice;

  Doubled(std::size_t count, std::uint64_t seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    for (std::size_t i = 0; i < count; ++i) {
      points.x.push_back(random.uniform());
      points.y.push_back(random.uniform());
    }
    twice = points;
    for (std::size_t i = 0; i < count; ++i) {
      twice.x.push_back(points.x[i] < 0.5 ? points.x[i] + 0.5 : points.x[i] - 0.5);
      twice.y.push_back(points.y[i] + 1.0);
    }
  }
};

TEST(ObliqueBox, CellsOfVoronoiAndTheirOrderAreThoseOfTwoBoxesInARectangle) {
  for (std::size_t const count : {1, 2, 3, 7, 40, 300}) {
    Doubled const both(count, count);
    VoronoiCells const one = find_voronoi_cells(both.box, both.points.in_memory());
    VoronoiCells const two = find_voronoi_cells(both.rectangle, both.twice.in_memory());
    auto const order = bond_orientations(both.box, both.points.in_memory(), one.neighbours);
    auto const order_of_two = bond_orientations(both.rectangle, both.twice.in_memory(), two.neighbours);
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      sum += one.areas[i];
      EXPECT_NEAR(one.areas[i], two.areas[i], 1e-10) << count;
      if (count < 40) continue;  // the nearest image of a neighbour may be another one than the neighbour
      EXPECT_EQ(one.neighbours.begin[i + 1] - one.neighbours.begin[i],
                two.neighbours.begin[i + 1] - two.neighbours.begin[i]);
      EXPECT_LT(std::abs(order[i] - order_of_two[i]), 1e-9);
    }
    EXPECT_NEAR(sum, 1.0, 1e-10) << count;
  }
}

TEST(ObliqueBox, PairCorrelationsCountThePairsOfBruteForceForEveryTwoKinds) {
  Doubled const both(200, 5);
  std::vector<std::uint32_t> kinds;
  for (std::uint32_t i = 0; i < 200; ++i) kinds.push_back(i % 3 == 0 ? 1 : 0);
  constexpr std::size_t bins = 20;
  double const range = 0.45;
  PairCorrelations const found = find_pair_correlations(both.box, both.points.in_memory(), range, bins, kinds);
  ASSERT_EQ(found.kinds, 2U);
  std::vector<double> counts(4 * bins);
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t j = 0; j < 200; ++j) {
      if (i == j) continue;
      double const r = std::sqrt(squared_length(shortest(both.box, both.points[i], both.points[j])));
      if (r < range) counts[(kinds[i] * 2 + kinds[j]) * bins + static_cast<std::size_t>(r / range * bins)] += 1.0;
    }
  }
  double const sizes[] = {133.0, 67.0};
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t b = 0; b < 2; ++b) {
      double const pairs = sizes[a] * (a == b ? sizes[a] - 1.0 : sizes[b]);
      for (std::size_t k = 0; k < bins; ++k) {
        double const ring = 2.0 * 3.14159265358979324 * found.distance[k] * range / bins;
        EXPECT_NEAR(found.of(a, b)[k], counts[(a * 2 + b) * bins + k] / (pairs * ring), 1e-9) << a << b << k;
      }
    }
  }
}

TEST(ObliqueBox, SpectralDensityHasTheWaveVectorsOfTwoBoxesInARectangle) {
  Doubled const both(60, 9);
  std::vector<double> const radius(60, 0.02);
  std::vector<double> const radius_of_two(120, 0.02);
  // One bin: the sum over all wave vectors, of which those of the rectangle that the box has not cancel.
  SpectralDensity const one = find_spectral_density(both.box, both.points.in_memory(), radius, 60.0, 1);
  SpectralDensity const two = find_spectral_density(both.rectangle, both.twice.in_memory(), radius_of_two, 60.0, 1);
  double const sum = one.density[0] * static_cast<double>(one.vectors[0]);
  double const sum_of_two = two.density[0] * static_cast<double>(two.vectors[0]);
  EXPECT_NEAR(sum_of_two, 2.0 * sum, 1e-9 * sum);
}

TEST(ObliqueBox, ObservablesVisitEachPairOnce) {
  Box const box = random_box(3);
  Points const points = random_points(box, 100, 3);
  State state{.box = box};
  for (std::size_t i = 0; i < 100; ++i) {
    Vector const p = box.inside(points[i]);
    state.agents.add(p.x, p.y, 0.0, 0.0, 0.01, 1.0, 0, 0);
  }
  Counters const counters;
  Pairs found;
  Snapshot(state, counters).pairs(0.1, [&](NearPair const& pair) {
    EXPECT_EQ(pair.own, 2U);
    EXPECT_TRUE(found.emplace(std::max(pair.i, pair.j), std::min(pair.i, pair.j)).second);
  });
  EXPECT_EQ(found, brute_force(box, points, 0.1));
}

}  // namespace
}  // namespace gridlock
