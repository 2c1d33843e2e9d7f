#include "gridlock/grid/tiling.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace gridlock {
namespace {

/// The tile each cell is in, or −1; fails where a cell is in two.
std::vector<int> owners(CellLayout const& layout, Tiling const& tiling) {
  std::vector<int> owner(static_cast<std::size_t>(layout.count()), -1);
  for (std::size_t t = 0; t < tiling.tiles().size(); ++t) {
    Tiling::Tile const& tile = tiling.tiles()[t];
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int column = tile.first_column; column < tile.end_column; ++column) {
        int& cell = owner[static_cast<std::size_t>(row * layout.columns() + column)];
        EXPECT_EQ(cell, -1) << column << ", " << row;
        cell = static_cast<int>(t);
      }
    }
  }
  return owner;
}

class TilingOf : public testing::TestWithParam<Edge> {};

TEST_P(TilingOf, EveryNumberOfCellsHasEachCellInOneTile) {
  for (int columns : {1, 2, 3, 5, 11, 12, 13, 24, 25, 35, 36, 37, 100}) {
    for (int rows : {1, 3, 12, 23, 24, 49}) {
      CellLayout const layout(Box(1.0, 2.0, GetParam()), columns, rows);
      for (int const owner : owners(layout, Tiling(layout))) ASSERT_GE(owner, 0) << columns << " × " << rows;
    }
  }
}

/// Two tiles of one colour have no cell in common even when each grows by the ring of cells around it.
TEST_P(TilingOf, TilesOfOneColourNeverTouchTheSameCell) {
  for (int columns : {1, 2, 3, 4, 5, 7, 12, 24, 25, 36, 37, 50}) {
    for (int rows : {1, 2, 3, 6, 25, 48}) {
      for (int const size : {2, 3, 12}) {
        CellLayout const layout(Box(1.0, 1.0, GetParam()), columns, rows);
        Tiling const tiling(layout, size);
        for (std::size_t colour = 0; colour < Tiling::colours; ++colour) {
          std::vector<int> touched(static_cast<std::size_t>(layout.count()), -1);
          for (std::size_t t = tiling.first_of(colour); t < tiling.first_of(colour + 1); ++t) {
            Tiling::Tile const& tile = tiling.tiles()[t];
            for (int row = tile.first_row; row < tile.end_row; ++row) {
              for (int column = tile.first_column; column < tile.end_column; ++column) {
                layout.for_each_cell_in_block(row * columns + column, 1, 1, [&](int cell) {
                  int& by = touched[static_cast<std::size_t>(cell)];
                  ASSERT_TRUE(by == -1 || by == static_cast<int>(t))
                      << columns << " × " << rows << " cells, tiles of " << size << ", colour " << colour;
                  by = static_cast<int>(t);
                });
              }
            }
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Edges, TilingOf, testing::Values(Edge::wall, Edge::periodic),
                         [](auto const& edge) { return edge.param == Edge::wall ? "walls" : "periodic"; });

}  // namespace
}  // namespace gridlock
