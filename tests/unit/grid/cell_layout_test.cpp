#include "gridlock/grid/cell_layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

std::vector<int> block(CellLayout const& layout, int cell, int reach_columns, int reach_rows) {
  std::vector<int> cells;
  layout.for_each_cell_in_block(cell, reach_columns, reach_rows, [&](int c) { cells.push_back(c); });
  std::ranges::sort(cells);
  return cells;
}

TEST(CellLayout, NumbersCellsRowByRowFromTheLowerLeft) {
  CellLayout const layout(Box(3.0, 2.0, Edge::wall), 3, 2);
  EXPECT_EQ(layout.count(), 6);
  EXPECT_EQ(layout.cell_width(), 1.0);
  EXPECT_EQ(layout.cell_height(), 1.0);
  EXPECT_EQ(layout.cell_of({0.5, 0.5}), 0);
  EXPECT_EQ(layout.cell_of({2.5, 0.5}), 2);
  EXPECT_EQ(layout.cell_of({0.5, 1.5}), 3);
  EXPECT_EQ(layout.cell_of({2.5, 1.5}), 5);
}

TEST(CellLayout, APointOnTheBorderOfTwoCellsBelongsToTheUpperOne) {
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 4);
  EXPECT_EQ(layout.column_of(0.25), 1);
  EXPECT_EQ(layout.column_of(std::nextafter(0.25, 0.0)), 0);
  EXPECT_EQ(layout.row_of(0.75), 3);
}

TEST(CellLayout, PutsPointsOutsideTheBoxInTheNearestCell) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 4);
  for (double const low : {-0.0, -1e-300, -0.3, -5.0, -1e300, -infinity}) EXPECT_EQ(layout.column_of(low), 0) << low;
  for (double const high : {1.0, 1.3, 5.0, 1e300, infinity}) EXPECT_EQ(layout.column_of(high), 3) << high;
  EXPECT_EQ(layout.column_of(std::nan("")), 0) << "no undefined conversion";
}

TEST(CellLayout, PutsPointsOutsideAPeriodicBoxInTheCellOfTheirImage) {
  CellLayout const layout(Box(1.0, 2.0, Edge::periodic), 4, 4);
  for (double const x : {0.3, -0.7, 1.3, -5.7, 1e6 + 0.3}) EXPECT_EQ(layout.column_of(x), 1) << x;
  for (double const y : {1.9, -0.1, 3.9, -4.1}) EXPECT_EQ(layout.row_of(y), 3) << y;
  for (double const edge : {0.0, -0.0, 1.0, -1.0, 7.0, -1e-300}) EXPECT_EQ(layout.column_of(edge), 0) << edge;
  EXPECT_EQ(layout.column_of(-0x1.0p-53), 3);
  EXPECT_EQ(layout.column_of(std::nan("")), 0) << "no undefined conversion";
  EXPECT_EQ(layout.cell_of({-0.25, -0.5}), layout.cell_of({0.75, 1.5}));
  EXPECT_EQ(layout.image_in_cell({-0.25, 5.5}), (Vector{0.75, 1.5}));
  EXPECT_EQ(layout.image_in_cell({0.25, 1.5}), (Vector{0.25, 1.5}));
  CellLayout const between_walls(Box(1.0, 2.0, Edge::wall), 4, 4);
  EXPECT_EQ(between_walls.image_in_cell({-0.25, 5.5}), (Vector{-0.25, 5.5}));
}

TEST(CellLayout, APointAndItsImageInACellAreInOneCellForAnySides) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  for (int n = 0; n < 50000; ++n) {
    Box const box(0.01 + 10.0 * random.uniform(), 1.0, Edge::periodic);
    CellLayout const layout(box, 1 + random.below(1000), 1);
    double x = static_cast<double>(random.below(7)) * box.width() - 3.0 * box.width();
    if (n % 2 == 0) x += random.uniform() * box.width();
    if (n % 3 == 0) x = std::nextafter(x, n % 6 == 0 ? -100.0 : 100.0);
    double const image = layout.image_in_cell({x, 0.0}).x;
    ASSERT_EQ(layout.column_of(image), layout.column_of(x)) << x << " in " << box.width();
    ASSERT_LE(layout.column_of(x) * layout.cell_width(), image + 1e-12 * box.width());
    ASSERT_GE((layout.column_of(x) + 1) * layout.cell_width(), image - 1e-12 * box.width());
    ASSERT_EQ(layout.image_in_cell({image, 0.0}).x, image);
  }
}

TEST(CellLayout, ColumnsNeverFallAlongTheBox) {
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (int n = 0; n < 2000; ++n) {
    Box const box(0.01 + 10.0 * random.uniform(), 1.0, Edge::wall);
    CellLayout const layout(box, 1 + random.below(1000), 1);
    double const x = random.uniform() * box.width();
    ASSERT_LE(layout.column_of(x), layout.column_of(std::nextafter(x, 100.0)));
    // Off by rounding at most: the border of a column is where it should be to 1e-12 of the side.
    ASSERT_NEAR(layout.column_of(x), std::floor(x / layout.cell_width()), 1.0);
    ASSERT_LE(layout.column_of(x) * layout.cell_width(), x + 1e-12 * box.width());
    ASSERT_GE((layout.column_of(x) + 1) * layout.cell_width(), x - 1e-12 * box.width());
  }
}

TEST(CellLayout, TheBlockBetweenWallsEndsAtTheWalls) {
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 4, 3);
  EXPECT_EQ(block(layout, 0, 1, 1), (std::vector<int>{0, 1, 4, 5}));
  EXPECT_EQ(block(layout, 11, 1, 1), (std::vector<int>{6, 7, 10, 11}));
  EXPECT_EQ(block(layout, 5, 1, 1), (std::vector<int>{0, 1, 2, 4, 5, 6, 8, 9, 10}));
  EXPECT_EQ(block(layout, 5, 2, 0), (std::vector<int>{4, 5, 6, 7}));
  EXPECT_EQ(block(layout, 5, 0, 0), (std::vector<int>{5}));
}

TEST(CellLayout, ThePeriodicBlockContinuesOnTheOtherSide) {
  CellLayout const layout(Box(1.0, 1.0, Edge::periodic), 4, 4);
  EXPECT_EQ(block(layout, 0, 1, 1), (std::vector<int>{0, 1, 3, 4, 5, 7, 12, 13, 15}));
  EXPECT_EQ(block(layout, 15, 1, 1), (std::vector<int>{0, 2, 3, 8, 10, 11, 12, 14, 15}));
}

TEST(CellLayout, ABlockNamesNoCellTwiceHoweverSmallTheBox) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (std::uint64_t columns = 1; columns <= 6; ++columns) {
      for (std::uint64_t rows = 1; rows <= 6; ++rows) {
        CellLayout const layout(Box(1.0, 1.0, edge), columns, rows);
        for (int cell = 0; cell < layout.count(); ++cell) {
          for (int reach_columns = 0; reach_columns <= layout.columns(); ++reach_columns) {
            for (int reach_rows = 0; reach_rows <= layout.rows(); ++reach_rows) {
              // What belongs to the block, straight from the definition: cells whose distance, around a periodic box
              // the shorter way, is at most the cutoff.
              auto const distance = [&](int a, int b, int count) {
                int const d = std::abs(a - b);
                return edge == Edge::periodic ? std::min(d, count - d) : d;
              };
              std::vector<int> expected;
              for (int c = 0; c < layout.count(); ++c) {
                bool const is_near =
                    distance(c % layout.columns(), cell % layout.columns(), layout.columns()) <= reach_columns &&
                    distance(c / layout.columns(), cell / layout.columns(), layout.rows()) <= reach_rows;
                if (is_near) expected.push_back(c);
              }
              ASSERT_EQ(block(layout, cell, reach_columns, reach_rows), expected)
                  << columns << " × " << rows << " cell " << cell << " reach " << reach_columns << ", " << reach_rows;
            }
          }
        }
      }
    }
  }
}

TEST(CellLayout, APointIsInABlockIfItsCellIs) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (auto const& [columns, rows] : {std::pair(1, 1), std::pair(2, 3), std::pair(4, 1), std::pair(5, 6)}) {
      CellLayout const layout(Box(1.0, 1.0, edge), columns, rows);
      for (int cell = 0; cell < layout.count(); ++cell) {
        std::vector<int> const near = block(layout, cell, 1, 1);
        for (int other = 0; other < layout.count(); ++other) {
          Vector const middle{(other % columns + 0.5) / columns, (other / columns + 0.5) / rows};
          EXPECT_EQ(layout.is_in_block(cell, middle), std::ranges::binary_search(near, other)) << cell << ' ' << other;
        }
      }
    }
  }
}

TEST(CellLayout, CountsTheCellsWithinADistance) {
  CellLayout const layout(Box(1.0, 2.0, Edge::wall), 10, 4);  // cells of 0.1 × 0.5
  EXPECT_EQ(layout.columns_within(0.05), 1);
  EXPECT_EQ(layout.columns_within(0.15), 2);
  EXPECT_EQ(layout.columns_within(0.85), 9);
  EXPECT_EQ(layout.columns_within(5.0), 10) << "never more than there are";
  EXPECT_EQ(layout.columns_within(std::numeric_limits<double>::infinity()), 10);
  EXPECT_EQ(layout.rows_within(0.49), 1);
  EXPECT_EQ(layout.rows_within(0.51), 2);
}

/// The smallest number that lies in a column or beyond.
double lower_border(CellLayout const& layout, int column) {
  double x = column * layout.cell_width();
  while (layout.column_of(x) < column) x = std::nextafter(x, 10.0);
  while (x > 0.0 && layout.column_of(std::nextafter(x, -1.0)) >= column) x = std::nextafter(x, -1.0);
  return x;
}

TEST(CellLayout, PointsNearerThanADistanceLieWithinItsCells) {
  RandomStream random(2, 0, 0, Purpose::start_position);
  for (int n = 0; n < 20000; ++n) {
    Box const box(0.1 + random.uniform(), 1.0, Edge::wall);
    CellLayout const layout(box, 10 + random.below(2000), 1);
    // From the last point of a column to the first point of another: the nearest two points so many columns apart,
    // whose distance is a whole number of cells but for rounding.
    int const from = static_cast<int>(random.below(static_cast<std::uint64_t>(layout.columns() - 8)));
    int const to = from + 1 + static_cast<int>(random.below(6));
    double const a = std::nextafter(lower_border(layout, from + 1), 0.0);
    double const b = lower_border(layout, to);
    ASSERT_EQ(layout.column_of(a), from);
    ASSERT_EQ(layout.column_of(b), to);
    ASSERT_LE(to - from, layout.columns_within(b - a)) << "a " << a << " b " << b << " columns " << layout.columns();
    double const anywhere = random.uniform() * box.width();
    double const other = random.uniform() * box.width();
    ASSERT_LE(std::abs(layout.column_of(anywhere) - layout.column_of(other)),
              layout.columns_within(std::abs(anywhere - other)));
  }
}

TEST(CellLayout, RefusesNoCellsAndTooMany) {
  Box const box(1.0, 1.0, Edge::wall);
  EXPECT_THROW(CellLayout(box, 0, 3), Error);
  EXPECT_THROW(CellLayout(box, 3, 0), Error);
  EXPECT_THROW(CellLayout(box, std::uint64_t{1} << 16, std::uint64_t{1} << 15), Error);
  EXPECT_THROW(CellLayout(box, ~std::uint64_t{0}, 1), Error);
  EXPECT_THROW(CellLayout(box, std::uint64_t{1} << 32, std::uint64_t{1} << 32), Error) << "the product overflows to 0";
  EXPECT_NO_THROW(CellLayout(box, 46340, 46340));
}

TEST(LayoutForCutoff, IsTheFinestWhose3By3BlockIsEnough) {
  Box const box(1.0, 2.0, Edge::periodic);
  CellLayout const layout = layout_for_cutoff(box, 0.15, 1000);
  EXPECT_EQ(layout.columns(), 6);
  EXPECT_EQ(layout.rows(), 13);
  EXPECT_EQ(layout.columns_within(0.15), 1);
  EXPECT_EQ(layout.rows_within(0.15), 1);
}

TEST(LayoutForCutoff, ASideOfExactlyNReachesStillNeedsOneRingOnly) {
  for (std::uint64_t n = 1; n < 200; ++n) {
    double const side = 0.1 * static_cast<double>(n);
    CellLayout const layout = layout_for_cutoff(Box(side, side, Edge::wall), 0.1, 100000);
    ASSERT_LE(layout.columns_within(0.1), 1) << n;
    ASSERT_GE(layout.columns(), static_cast<int>(n) - 1) << n;
  }
}

TEST(LayoutForCutoff, MakesOneCellOfABoxSmallerThanTheCutoff) {
  EXPECT_EQ(layout_for_cutoff(Box(1.0, 1.0, Edge::periodic), 5.0, 10).count(), 1);
}

TEST(LayoutForCutoff, MakesNoMoreThanAboutTwoCellsAnAgent) {
  for (std::size_t const agents :
       {std::size_t{0}, std::size_t{1}, std::size_t{10}, std::size_t{841}, std::size_t{100000}}) {
    for (double const width : {1e-4, 0.1, 1.0, 10.0, 1e4}) {
      CellLayout const layout = layout_for_cutoff(Box(width, 1.0, Edge::wall), 1e-9, agents);
      double const most = 2.0 * static_cast<double>(agents) + 1.0;
      double const margin = layout.columns() + layout.rows() + 1.0;  // rounding up each side
      EXPECT_LE(layout.count(), most + margin) << agents << " agents, width " << width;
      EXPECT_LE(layout.columns(), most) << agents << " agents, width " << width;
      EXPECT_LE(layout.rows(), most) << agents << " agents, width " << width;
      EXPECT_GE(layout.count(), 0.5 * static_cast<double>(agents)) << "long lists are as bad as empty cells";
    }
  }
}

}  // namespace
}  // namespace gridlock
