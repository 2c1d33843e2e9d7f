#include "gridlock/grid/voronoi.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "grid/voronoi_polygon.hpp"
#include "gridlock/core/error.hpp"
#include "unit/analysis/points.hpp"

namespace gridlock {
namespace {

double sum(std::vector<double> const& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(VoronoiCells, FillTheBoxAndHaveSixSidesOnAverage) {
  for (auto const& [width, height] : {std::pair(1.0, 1.0), std::pair(30.0, 1.0), std::pair(1.0, 1e5)}) {
    for (std::size_t const count : {5UL, 100UL, 3000UL}) {
      Box const box(width, height, Edge::periodic);
      RandomPoints const points(count, width, height);
      VoronoiCells const cells = find_voronoi_cells(box, points.view());
      EXPECT_NEAR(sum(cells.areas), box.area(), 1e-9 * box.area());
      EXPECT_EQ(cells.neighbours.begin.back(), 6 * count) << count << " points, height " << height;
    }
  }
}

TEST(VoronoiCells, HoldExactlyThePlacesThatAreNearest) {
  // The share of random places that are nearest to a point is the area of its cell.
  for (Edge const edge : {Edge::periodic, Edge::wall}) {
    Box const box(1.0, 1.0, edge);
    RandomPoints const points(12, 1.0, 1.0);
    VoronoiCells const cells = find_voronoi_cells(box, points.view());
    std::vector<double> share(12, 0.0);
    int const side = 1000;
    for (int k = 0; k < side * side; ++k) {
      Vector const place{(k % side + 0.5) / side, (k / side + 0.5) / side};
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < 12; ++i) {
        double const here = squared_length(box.displacement(points[i], place));
        if (here < squared_length(box.displacement(points[nearest], place))) nearest = i;
      }
      share[nearest] += 1.0 / (side * side);
    }
    for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(cells.areas[i], share[i], 1e-3);
  }
}

TEST(VoronoiCells, InAChannelAreThoseOfAPeriodicBoxWithTheirMirrorImages) {
  // A wall is the bisector of a point and its mirror image.
  for (bool const is_upright : {false, true}) {
    Box const channel =
        is_upright ? Box(0.7, 1.3, Edge::wall, Edge::periodic) : Box(1.3, 0.7, Edge::periodic, Edge::wall);
    Box const doubled(is_upright ? 1.4 : 1.3, is_upright ? 1.3 : 1.4, Edge::periodic);
    for (std::size_t const count : {1UL, 2UL, 3UL, 10UL, 200UL}) {
      RandomPoints const points(count, channel.width(), channel.height());
      std::vector<double> x;
      std::vector<double> y;
      for (int const mirrored : {0, 1}) {
        for (std::size_t i = 0; i < count; ++i) {
          x.push_back(is_upright && mirrored == 1 ? 1.4 - points[i].x : points[i].x);
          y.push_back(!is_upright && mirrored == 1 ? 1.4 - points[i].y : points[i].y);
        }
      }
      VoronoiCells const cells = find_voronoi_cells(channel, points.view());
      VoronoiCells const expected = find_voronoi_cells(doubled, {.x = x.data(), .y = y.data(), .count = 2 * count});
      EXPECT_NEAR(sum(cells.areas), channel.area(), 1e-12);
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_NEAR(cells.areas[i], expected.areas[i], 1e-12);
        auto const neighbours_of = [&](VoronoiCells const& some) {
          std::vector<std::uint32_t> found;
          for (std::uint64_t k = some.neighbours.begin[i]; k < some.neighbours.begin[i + 1]; ++k) {
            if (some.neighbours.neighbours[k] < count) found.push_back(some.neighbours.neighbours[k]);
          }
          std::ranges::sort(found);
          return found;
        };
        EXPECT_EQ(neighbours_of(cells), neighbours_of(expected));
      }
    }
  }
}

TEST(VoronoiCells, OfFewPointsInBoxesOfAnyShapeAreCutByAllOthers) {
  for (double const height : {0.07, 0.3, 0.5, 0.7, 1.4, 2.2, 3.5, 9.0}) {
    for (std::size_t count = 2; count <= 24; ++count) {
      for (Edge const edge : {Edge::periodic, Edge::wall}) {
        Box const box(1.0, height, edge);
        RandomPoints const points(count, 1.0, height);
        VoronoiCells const cells = find_voronoi_cells(box, points.view());
        int const images = edge == Edge::periodic ? 2 : 0;
        for (std::size_t i = 0; i < count; ++i) {
          VoronoiPolygon polygon;
          Vector const half{0.5, 0.5 * height};
          Vector const p = points[i];
          edge == Edge::periodic
              ? polygon.begin(-1.0 * half, half, 0, 0)
              : polygon.begin(-1.0 * p, Vector{1.0, height} - p, VoronoiPolygon::nobody, VoronoiPolygon::nobody);
          for (std::size_t other = 0; other < count; ++other) {
            for (int m = -images; m <= images; ++m) {
              for (int n = -images; n <= images; ++n) {
                Vector const separation = points[other] + Vector{1.0 * m, height * n} - p;
                if (squared_length(separation) > 0.0) polygon.cut(separation, 0);
              }
            }
          }
          ASSERT_NEAR(cells.areas[i], polygon.area(), 1e-9 * height) << count << " points, height " << height;
        }
      }
    }
  }
}

TEST(VoronoiCells, OfLatticesHaveFourAndSixSides) {
  std::vector<double> square, triangular;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      square.insert(square.end(), {column + 0.3, row + 0.7});
      triangular.insert(triangular.end(), {column + 0.5 * (row % 2), row * std::sqrt(0.75)});
    }
  }
  auto const view = [](std::vector<double> const& values) {
    return PointsInMemory{.x = values.data(), .y = values.data() + 1, .count = 64, .stride = 2};
  };
  VoronoiCells const four = find_voronoi_cells(Box(8.0, 8.0, Edge::periodic), view(square));
  VoronoiCells const six = find_voronoi_cells(Box(8.0, 8.0 * std::sqrt(0.75), Edge::periodic), view(triangular));
  for (std::size_t i = 0; i < 64; ++i) {
    EXPECT_EQ(four.neighbours.begin[i + 1], 4 * (i + 1));
    EXPECT_EQ(six.neighbours.begin[i + 1], 6 * (i + 1));
    EXPECT_NEAR(four.areas[i], 1.0, 1e-12);
  }
}

TEST(VoronoiCells, DoNotDependOnTheThreadsAndKnowOneAnother) {
  Box const box(1.0, 2.0, Edge::wall);
  RandomPoints const points(2000, 1.0, 2.0);
  VoronoiCells const one = find_voronoi_cells(box, points.view(), 1);
  VoronoiCells const three = find_voronoi_cells(box, points.view(), 3);
  EXPECT_EQ(one.areas, three.areas);
  EXPECT_EQ(one.neighbours.begin, three.neighbours.begin);
  EXPECT_EQ(one.neighbours.neighbours, three.neighbours.neighbours);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> there, back;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    for (auto k = one.neighbours.begin[i]; k < one.neighbours.begin[i + 1]; ++k) {
      there.emplace_back(i, one.neighbours.neighbours[k]);
      back.emplace_back(one.neighbours.neighbours[k], i);
    }
  }
  std::ranges::sort(there);
  std::ranges::sort(back);
  EXPECT_EQ(there, back);
}

TEST(VoronoiCells, OfVeryUnevenPointsAreWhole) {
  // Nearly all points lie in a hundredth of the box.
  RandomPoints points(2000, 0.1, 0.1);
  points.values[0] = 0.9;
  points.values[1] = 0.8;
  VoronoiCells const cells = find_voronoi_cells(Box(1.0, 1.0, Edge::periodic), points.view());
  EXPECT_NEAR(sum(cells.areas), 1.0, 1e-9);
  EXPECT_EQ(cells.neighbours.begin.back(), 12'000U);
}

TEST(VoronoiCells, RefusePointsThatHaveNone) {
  Box const walls(1.0, 1.0, Edge::wall);
  RandomPoints points(50, 1.0, 1.0);
  EXPECT_NO_THROW(find_voronoi_cells(walls, points.view()));
  EXPECT_TRUE(find_voronoi_cells(walls, {}).areas.empty());
  std::vector<double> twice = points.values;
  twice[42] = twice[6];
  twice[43] = twice[7];
  try {
    find_voronoi_cells(walls, {.x = twice.data(), .y = twice.data() + 1, .count = 50, .stride = 2});
    FAIL();
  } catch (Error const& error) {
    EXPECT_NE(std::string(error.what()).find("the points 3 and 21 are at the same place"), std::string::npos);
  }
  points.values[0] = 1.5;
  EXPECT_THROW(find_voronoi_cells(walls, points.view()), Error);
  EXPECT_NO_THROW(find_voronoi_cells(Box(1.0, 1.0, Edge::periodic), points.view()));
  points.values[0] = std::nan("");
  EXPECT_THROW(find_voronoi_cells(Box(1.0, 1.0, Edge::periodic), points.view()), Error);
}

}  // namespace
}  // namespace gridlock
