#include "gridlock/core/box.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

TEST(Box, RefusesASideThatIsNotPositiveAndFiniteNamingIt) {
  for (double const side : {0.0, -1.0, infinity, std::nan("")}) {
    EXPECT_THROW(Box(side, 1.0, Edge::wall), Error);
    try {
      Box const box(1.0, side, Edge::periodic);
      ADD_FAILURE() << "a height of " << side << " was accepted";
    } catch (Error const& error) {
      EXPECT_EQ(error.problems().at(0).key, "box.height");
      EXPECT_NE(error.problems().at(0).what.find("height"), std::string::npos);
      EXPECT_FALSE(error.problems().at(0).hint.empty());
    }
  }
}

TEST(Box, SideIsTheSquareRootOfTheAreaAndExactForSquares) {
  EXPECT_EQ(Box(0.1, 0.1, Edge::wall).side(), 0.1);
  EXPECT_DOUBLE_EQ(Box(2.0, 8.0, Edge::wall).side(), 4.0);
  EXPECT_DOUBLE_EQ(Box(2.0, 8.0, Edge::wall).area(), 16.0);
}

TEST(Box, DisplacementBetweenWallsIsThePlainDifference) {
  Box const box(1.0, 1.0, Edge::wall);
  EXPECT_EQ(box.displacement({0.125, 0.75}, {0.875, 0.25}), (Vector{0.75, -0.5}));
}

TEST(Box, PeriodicDisplacementIsTheNearestImage) {
  Box const box(1.0, 2.0, Edge::periodic);
  EXPECT_EQ(box.displacement({0.125, 0.125}, {0.875, 1.875}), (Vector{-0.25, -0.25}));
  EXPECT_EQ(box.displacement({0.875, 1.875}, {0.125, 0.125}), (Vector{0.25, 0.25}));
  EXPECT_EQ(box.displacement({0.25, 0.25}, {0.5, 1.0}), (Vector{0.25, 0.75})) << "half the height is 1, not 0.5";
}

TEST(Box, PeriodicDisplacementIsNeverLongerThanHalfTheSidesAndNoOtherImageIsNearer) {
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (int n = 0; n < 20000; ++n) {
    Box const box(0.1 + 3.0 * random.uniform(), 0.1 + 3.0 * random.uniform(), Edge::periodic);
    Vector const a{random.uniform() * box.width(), random.uniform() * box.height()};
    Vector const b{random.uniform() * box.width(), random.uniform() * box.height()};
    Vector const d = box.displacement(a, b);
    ASSERT_LE(std::abs(d.x), 0.5 * box.width());
    ASSERT_LE(std::abs(d.y), 0.5 * box.height());
    for (int const image : {-1, 0, 1}) {
      ASSERT_LE(std::abs(d.x), std::abs(b.x - a.x + image * box.width()) + 1e-15);
      ASSERT_LE(std::abs(d.y), std::abs(b.y - a.y + image * box.height()) + 1e-15);
    }
  }
}

TEST(Box, DisplacementIsAntisymmetricToTheLastBit) {
  RandomStream random(2, 0, 0, Purpose::start_position);
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (int n = 0; n < 20000; ++n) {
      Box const box(0.1 + random.uniform(), 0.1 + random.uniform(), edge);
      // Every fourth pair is exactly half a side apart, or a last bit to either side of it: the edge of two images.
      Vector const a{random.uniform() * box.width(), random.uniform() * box.height()};
      Vector b{random.uniform() * box.width(), random.uniform() * box.height()};
      if (n % 4 == 0) b.x = a.x + (a.x < 0.5 * box.width() ? 0.5 : -0.5) * box.width();
      if (n % 8 == 0) b.x = std::nextafter(b.x, n % 16 == 0 ? 0.0 : infinity);
      Vector const forth = box.displacement(a, b);
      Vector const back = box.displacement(b, a);
      // Zero is the one number with two signs; a − a is +0 both ways.
      ASSERT_EQ(bits(forth.x), forth.x == 0.0 ? bits(back.x) : bits(-back.x));
      ASSERT_EQ(bits(forth.y), forth.y == 0.0 ? bits(back.y) : bits(-back.y));
      ASSERT_EQ(bits(squared_length(forth)), bits(squared_length(back))) << "two disks must agree whether they overlap";
    }
  }
}

TEST(Box, PeriodicDisplacementIsTheNearestImageForPointsOutside) {
  Box const box(1.0, 2.0, Edge::periodic);
  EXPECT_EQ(box.displacement({-0.25, 0.0}, {0.625, 0.0}), (Vector{-0.125, 0.0}));
  EXPECT_EQ(box.displacement({-3.25, 9.5}, {2.0, -4.75}), (Vector{0.25, -0.25}));
  EXPECT_EQ(box.displacement({1e6, 0.25}, {0.125, 1e6}), (Vector{0.125, -0.25}));
  EXPECT_EQ(box.displacement({-1e308, 0.5}, {1e308, 0.25}).y, -0.25) << "their difference is no number";
  EXPECT_LE(std::abs(box.displacement({-1e308, 0.5}, {1e308, 0.25}).x), 0.5);
}

TEST(Box, PeriodicDisplacementOfPointsOutsideIsThatOfTheirImages) {
  RandomStream random(4, 0, 0, Purpose::start_position);
  for (int n = 0; n < 50000; ++n) {
    Box const box(0.1 + 3.0 * random.uniform(), 0.1 + 3.0 * random.uniform(), Edge::periodic);
    double const boxes = std::array{1.0, 3.0, 1e3, 1e9}[random.below(4)];
    auto const coordinate = [&] { return boxes * (2.0 * random.uniform() - 1.0) * box.width(); };
    Vector const a{coordinate(), 0.0};
    // Every fourth pair is half a side apart, give or take whole ones.
    Vector const b{n % 4 == 0 ? a.x + (static_cast<double>(random.below(9)) - 3.5) * box.width() : coordinate(), 0.0};
    double const d = box.displacement(a, b).x;
    ASSERT_LE(std::abs(d), 0.5 * box.width());
    ASSERT_EQ(bits(std::abs(d)), bits(std::abs(box.displacement(b, a).x))) << "two disks must agree";
    long double const exact = std::remainder(static_cast<long double>(b.x) - static_cast<long double>(a.x),
                                             static_cast<long double>(box.width()));
    // Half a side either way is the same distance. The difference itself is exact to the 64 bits of a long double.
    ASSERT_NEAR(std::abs(d), static_cast<double>(std::abs(exact)), (1e-15 + 1e-18 * boxes) * box.width());
  }
}

TEST(Box, DisplacementInsideHasTheBitsOfDisplacement) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (int n = 0; n < 20000; ++n) {
      Box const box(0.1 + random.uniform(), 0.1 + random.uniform(), edge);
      Vector const a{random.uniform() * box.width(), random.uniform() * box.height()};
      Vector const b{random.uniform() * box.width(), n % 4 == 0 ? a.y : random.uniform() * box.height()};
      Vector const d = box.displacement_inside(a, b);
      ASSERT_EQ(bits(d.x), bits(box.displacement(a, b).x));
      ASSERT_EQ(bits(d.y), bits(box.displacement(a, b).y));
    }
  }
}

TEST(Box, TreatsEachAxisAsABoxOfItsOwnEdgeDoesToTheLastBit) {
  RandomStream random(8, 0, 0, Purpose::start_position);
  for (int n = 0; n < 40000; ++n) {
    double const width = 0.1 + 3.0 * random.uniform();
    double const height = 0.1 + random.uniform();
    Edge const edge_x = random.below(2) == 0 ? Edge::wall : Edge::periodic;
    Edge const edge_y = random.below(2) == 0 ? Edge::wall : Edge::periodic;
    Box const box(width, height, edge_x, edge_y);
    Box const like_x(width, height, edge_x);
    Box const like_y(width, height, edge_y);
    double const boxes = n % 2 == 0 ? 1.0 : 5.0;
    auto const any_point = [&] {
      return Vector{(boxes * random.uniform() - 0.4 * (boxes - 1.0)) * width,
                    (boxes * random.uniform() - 0.4 * (boxes - 1.0)) * height};
    };
    Vector const a = any_point();
    Vector const b = any_point();
    ASSERT_EQ(bits(box.displacement(a, b).x), bits(like_x.displacement(a, b).x));
    ASSERT_EQ(bits(box.displacement(a, b).y), bits(like_y.displacement(a, b).y));
    if (boxes == 1.0) {
      ASSERT_EQ(bits(box.displacement_inside(a, b).x), bits(like_x.displacement_inside(a, b).x));
      ASSERT_EQ(bits(box.displacement_inside(a, b).y), bits(like_y.displacement_inside(a, b).y));
    }
    Vector const near{a.x + (random.uniform() - 0.5) * width, a.y + (random.uniform() - 0.5) * height};
    if (boxes != 1.0) continue;
    int crossed[6] = {};
    Vector const wrapped = box.wrap(near, crossed[0], crossed[1]);
    ASSERT_EQ(bits(wrapped.x), bits(like_x.wrap(near, crossed[2], crossed[3]).x));
    ASSERT_EQ(bits(wrapped.y), bits(like_y.wrap(near, crossed[4], crossed[5]).y));
    ASSERT_EQ(crossed[0], crossed[2]);
    ASSERT_EQ(crossed[1], crossed[5]);
  }
}

TEST(Box, KnowsItsEdgesByNumberAndByWords) {
  std::array<char const*, 4> const words{"walled", "periodic", "x-periodic, y-walled", "x-walled, y-periodic"};
  for (std::uint64_t number = 0; number < words.size(); ++number) {
    Box const box = box_with_edges(2.0, 1.0, number);
    EXPECT_EQ(number_of_edges(box), number);
    EXPECT_EQ(edges_in_words(box), words[number]);
    EXPECT_EQ(box.has_images(), number != 0);
    EXPECT_EQ(box.has_walls(), number != 1);
    EXPECT_EQ(box.period_x(), box.is_periodic_x() ? 2.0 : infinity);
    EXPECT_EQ(box.period_y(), box.is_periodic_y() ? 1.0 : infinity);
    EXPECT_EQ(box.shortest_period(), std::min(box.period_x(), box.period_y()));
  }
  EXPECT_THROW(static_cast<void>(box_with_edges(1.0, 1.0, 4)), Error);
}

TEST(ImageInside, LiesInTheBoxForAnyFiniteCoordinate) {
  EXPECT_EQ(image_inside(0.25, 1.0), 0.25);
  EXPECT_EQ(image_inside(-0.25, 1.0), 0.75);
  EXPECT_EQ(image_inside(1.0, 1.0), 0.0);
  EXPECT_EQ(image_inside(-4.75, 1.5), 1.25);
  EXPECT_EQ(image_inside(-1e-17, 1.0), 0.0) << "the lower edge of the next image, as Box::wrap() has it";
  RandomStream random(6, 0, 0, Purpose::start_position);
  for (int n = 0; n < 50000; ++n) {
    double const side = 1e-3 + random.uniform();
    double const p = std::pow(10.0, 30.0 * random.uniform() - 20.0) * (random.below(2) == 0 ? 1.0 : -1.0);
    double const image = image_inside(p, side);
    ASSERT_GE(image, 0.0) << p;
    ASSERT_LT(image, side) << p;
  }
}

struct WrapCase {
  double from;
  double to;
  int crossed;
};

class BoxWrap : public testing::TestWithParam<WrapCase> {};

TEST_P(BoxWrap, LandsInTheBoxAndCountsTheEdgesCrossed) {
  auto const [from, to, crossed] = GetParam();
  Box const box(1.0, 1.0, Edge::periodic);
  int x = 0;
  int y = 10;
  Vector const p = box.wrap({from, from}, x, y);
  EXPECT_EQ(p, (Vector{to, to}));
  EXPECT_EQ(x, crossed);
  EXPECT_EQ(y, 10 + crossed) << "the counts are added to";
}

INSTANTIATE_TEST_SUITE_P(Edges, BoxWrap,
                         testing::Values(WrapCase{0.5, 0.5, 0}, WrapCase{0.0, 0.0, 0}, WrapCase{1.0, 0.0, 1},
                                         WrapCase{1.25, 0.25, 1}, WrapCase{-0.25, 0.75, -1},
                                         // −ε + 1 rounds to 1, which is 0 of the image it came from.
                                         WrapCase{-1e-17, 0.0, 0},
                                         WrapCase{-std::numeric_limits<double>::denorm_min(), 0.0, 0},
                                         // One ulp below 1 and the smallest step that is not lost against it.
                                         WrapCase{0x1.fffffffffffffp-1, 0x1.fffffffffffffp-1, 0},
                                         WrapCase{-0x1.0p-53, 0x1.fffffffffffffp-1, -1}));

TEST(Box, WrapLeavesAWalledBoxAlone) {
  Box const box(1.0, 1.0, Edge::wall);
  int x = 0;
  int y = 0;
  EXPECT_EQ(box.wrap({-0.25, 1.5}, x, y), (Vector{-0.25, 1.5}));
  EXPECT_EQ(x, 0);
  EXPECT_EQ(y, 0);
}

TEST(Box, WrapOfAnyPointLessThanASideOutsideIsInsideForAnySide) {
  RandomStream random(3, 0, 0, Purpose::start_position);
  for (int n = 0; n < 50000; ++n) {
    Box const box(1e-3 + random.uniform(), 1e3 * (1e-3 + random.uniform()), Edge::periodic);
    // Half of the points lie within a few ulps of an edge, where rounding decides.
    double const x = n % 2 == 0 ? (3.0 * random.uniform() - 1.0) * box.width()
                                : static_cast<double>(random.below(9)) * 1e-17 - 4e-17 +
                                      static_cast<double>(random.below(2)) * box.width();
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const p = box.wrap({std::max(x, -box.width()), 0.0}, crossed_x, crossed_y);
    ASSERT_GE(p.x, 0.0);
    ASSERT_LT(p.x, box.width()) << "from " << x;
    ASSERT_NEAR(p.x + crossed_x * box.width(), x, 4e-16 * box.width()) << "position and count name the same point";
  }
}

}  // namespace
}  // namespace gridlock
