// How tiles are divided among ranks.

#include "gridlock/grid/detail/tile_division.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

Tiling tiling_of(int columns, int rows, Edge edge = Edge::wall) {
  return Tiling(CellLayout(Box(1.0, 1.0, edge), columns, rows));
}

std::uint64_t disks_in(Tiling const& tiling, std::vector<std::uint64_t> const& disks,
                       Tiling::Rectangle const& rectangle) {
  std::uint64_t sum = 0;
  rectangle.for_each_tile([&](std::size_t column, std::size_t row) { sum += disks[tiling.number_of(column, row)]; });
  return sum;
}

TEST(Division, GivesEveryTileToOneRank) {
  for (std::size_t const ranks : {1U, 2U, 3U, 7U, 16U, 200U}) {
    Tiling const tiling = tiling_of(130, 90);
    std::vector<std::uint64_t> const disks(tiling.tiles().size(), 5);
    std::vector<int> owners(disks.size(), 0);
    std::vector<Tiling::Rectangle> const division = divide_tiles(tiling, disks, ranks);
    ASSERT_EQ(division.size(), ranks);
    for (Tiling::Rectangle const& own : division) {
      own.for_each_tile([&](std::size_t column, std::size_t row) { ++owners[tiling.number_of(column, row)]; });
    }
    EXPECT_EQ(std::ranges::count(owners, 1), static_cast<std::ptrdiff_t>(owners.size())) << ranks << " ranks";
  }
}

TEST(Division, FollowsTheDisksAndNotTheArea) {
  Tiling const tiling = tiling_of(400, 400);
  RandomStream random(3, 0, 0, Purpose::start_position);
  std::vector<std::uint64_t> disks(tiling.tiles().size(), 0);
  // All in a corner, which is a sixteenth of the box.
  std::uint64_t all = 0;
  for (std::size_t row = 0; row < tiling.rows() / 4; ++row) {
    for (std::size_t column = 0; column < tiling.columns() / 4; ++column) {
      std::uint64_t& of_tile = disks[tiling.number_of(column, row)];
      of_tile = 100 + random.below(50);
      all += of_tile;
    }
  }
  for (std::size_t const ranks : {2U, 4U, 6U}) {
    for (Tiling::Rectangle const& own : divide_tiles(tiling, disks, ranks)) {
      double const share = static_cast<double>(disks_in(tiling, disks, own)) / static_cast<double>(all);
      EXPECT_NEAR(share * static_cast<double>(ranks), 1.0, 0.35) << ranks << " ranks";
    }
  }
}

TEST(Division, LeavesRanksWithoutTilesWhereThereAreNotEnough) {
  Tiling const tiling = tiling_of(4, 4);
  std::vector<std::uint64_t> const disks(tiling.tiles().size(), 3);
  std::vector<Tiling::Rectangle> const division = divide_tiles(tiling, disks, 50);
  std::size_t tiles = 0;
  for (Tiling::Rectangle const& own : division) tiles += own.tiles();
  EXPECT_EQ(tiles, tiling.tiles().size());
  EXPECT_EQ(std::ranges::count_if(division, [](auto const& own) { return own.tiles() == 0; }),
            static_cast<std::ptrdiff_t>(50 - tiling.tiles().size()));
}

TEST(Windows, HaveTheCellsInCommonThatBothHave) {
  RandomStream random(5, 0, 0, Purpose::start_position);
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    CellLayout const layout(Box(1.0, 1.0, edge), 9, 7);
    auto const any_window = [&] {
      int const column = static_cast<int>(random.below(9));
      int const row = static_cast<int>(random.below(7));
      return within(layout, {.first_column = column - 2,
                             .end_column = column + static_cast<int>(random.below(10)),
                             .first_row = row - 2,
                             .end_row = row + static_cast<int>(random.below(8))});
    };
    auto const cells_of = [&](CellWindow const& window) {
      std::set<int> cells;
      for (int row = window.first_row; row < window.end_row; ++row) {
        for (int column = window.first_column; column < window.end_column; ++column) {
          cells.insert((row + 7) % 7 * 9 + (column + 9) % 9);
        }
      }
      return cells;
    };
    for (int n = 0; n < 300; ++n) {
      CellWindow const one = any_window();
      CellWindow const other = any_window();
      std::vector<int> both;
      std::ranges::set_intersection(cells_of(one), cells_of(other), std::back_inserter(both));
      std::vector<int> common = common_cells(layout, one, other);
      std::ranges::sort(common);
      ASSERT_EQ(common, both);
      ASSERT_EQ(overlap(layout, one, other), !both.empty());
    }
  }
}

}  // namespace
}  // namespace gridlock
