#include "gridlock/grid/detail/packed_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

std::vector<std::size_t> in_cell(PackedGrid const& grid, int cell) {
  std::vector<std::size_t> agents;
  grid.for_each_in_cell(cell, [&](std::size_t agent) { agents.push_back(agent); });
  std::ranges::sort(agents);
  return agents;
}

using Agents = std::vector<std::size_t>;

PackedGrid four_packed_cells() { return PackedGrid(CellLayout(Box(1.0, 1.0, Edge::wall), 2, 2)); }

TEST(PackedGrid, StartsEmptyAndConsistent) {
  PackedGrid const grid = four_packed_cells();
  EXPECT_EQ(grid.size(), 0U);
  EXPECT_FALSE(grid.contains(0));
  EXPECT_TRUE(grid.is_consistent());
}

TEST(PackedGrid, HoldsEveryPointItIsMadeOfInItsCell) {
  std::vector<double> const x{0.1, 0.9, 0.1, 0.9, 0.2};
  std::vector<double> const y{0.1, 0.1, 0.9, 0.9, 0.2};
  PackedGrid const grid(CellLayout(Box(1.0, 1.0, Edge::wall), 2, 2), x, y);
  EXPECT_EQ(in_cell(grid, 0), (Agents{0, 4}));
  EXPECT_EQ(in_cell(grid, 1), (Agents{1}));
  EXPECT_EQ(in_cell(grid, 2), (Agents{2}));
  EXPECT_EQ(in_cell(grid, 3), (Agents{3}));
  EXPECT_EQ(grid.cell_of(3), 3);
  EXPECT_TRUE(grid.is_consistent());
}

TEST(PackedGrid, HasTheNeighboursOfAllCellsBetweenWallsAtTheSameDistances) {
  constexpr int columns = 3;
  constexpr int rows = 2;
  PackedGrid grid(CellLayout(Box(3.0, 2.0, Edge::wall), columns, rows));
  for (int cell = 0; cell < columns * rows; ++cell) {
    grid.insert(static_cast<std::size_t>(cell), {cell % columns + 0.5, cell / columns + 0.5});
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      for (int const up : {-1, 0, 1}) {
        for (int const right : {-1, 0, 1}) {
          PackedGrid::Block const& block = (&grid.block_at(column, row))[up * grid.blocks_in_row() + right];
          bool const is_cell = column + right >= 0 && column + right < columns && row + up >= 0 && row + up < rows;
          ASSERT_EQ(block.next, PackedGrid::none);
          ASSERT_EQ(block.count, is_cell ? 1 : 0) << column << ' ' << row << ' ' << right << ' ' << up;
          if (is_cell) {
            EXPECT_EQ(block.agent[0], static_cast<unsigned>((row + up) * columns + column + right));
          }
        }
      }
    }
  }
  EXPECT_TRUE(grid.is_consistent());
}

TEST(PackedGrid, HoldsAnyNumberOfAgentsInOneCellAndLosesThemInAnyOrder) {
  for (std::size_t const stride : {1U, 3U, 7U, 19U}) {
    constexpr std::size_t count = 20;
    PackedGrid grid = four_packed_cells();
    std::set<std::size_t> left;
    for (std::size_t agent = 0; agent < count; ++agent) {
      grid.insert(agent, {0.25, 0.25});
      left.insert(agent);
      ASSERT_TRUE(grid.is_consistent());
    }
    for (std::size_t n = 0; n < count; ++n) {
      std::size_t const agent = (n * stride + 5) % count;
      grid.erase(agent);
      left.erase(agent);
      ASSERT_TRUE(grid.is_consistent()) << "stride " << stride << ", after " << n;
      ASSERT_EQ(in_cell(grid, 0), Agents(left.begin(), left.end()));
      ASSERT_FALSE(grid.contains(agent));
    }
  }
}

TEST(PackedGrid, MovesAnAgentIntoAFullCellAndBack) {
  PackedGrid grid = four_packed_cells();
  for (std::size_t agent = 0; agent < 4; ++agent) grid.insert(agent, {0.25, 0.25});
  grid.insert(4, {0.75, 0.75});
  grid.move(4, {0.25, 0.25});
  EXPECT_EQ(in_cell(grid, 0), (Agents{0, 1, 2, 3, 4}));
  EXPECT_EQ(in_cell(grid, 3), Agents{});
  grid.move(0, {0.75, 0.75});
  EXPECT_EQ(in_cell(grid, 0), (Agents{1, 2, 3, 4}));
  EXPECT_EQ(in_cell(grid, 3), (Agents{0}));
  EXPECT_TRUE(grid.is_consistent());
}

TEST(PackedGrid, TakesTheAgentsOfACellInTheOrderOfAnotherGridForGood) {
  auto const visited = [](PackedGrid const& grid) {
    std::vector<std::uint32_t> agents;
    grid.for_each_in_cell(0, [&](std::size_t agent) { agents.push_back(static_cast<std::uint32_t>(agent)); });
    return agents;
  };
  auto const place_of = [](std::uint32_t /*agent*/) { return Vector{0.25, 0.25}; };
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    RandomStream random(seed, 0, 0, Purpose::start_position);
    PackedGrid grid = four_packed_cells();
    std::size_t const agents = random.below(30);
    for (std::size_t n = 0; n < 3 * agents; ++n) {
      std::size_t const agent = random.below(agents);
      grid.contains(agent) ? grid.erase(agent) : grid.insert(agent, {0.25, 0.25});
    }
    PackedGrid other = four_packed_cells();
    other.insert_in_order(visited(grid), place_of);
    ASSERT_TRUE(other.is_consistent());
    ASSERT_EQ(visited(other), visited(grid)) << "seed " << seed;
    for (std::size_t n = 0; n < agents; ++n) {
      std::size_t const agent = random.below(agents);
      bool const is_here = grid.contains(agent);
      for (PackedGrid* const one : {&grid, &other}) is_here ? one->erase(agent) : one->insert(agent, {0.25, 0.25});
      ASSERT_EQ(visited(other), visited(grid)) << "seed " << seed;
    }
  }
}

TEST(PackedGrid, TakesAgentsInAnyOrderWithGaps) {
  PackedGrid grid = four_packed_cells();
  grid.insert(40, {0.25, 0.25});
  grid.insert(7, {0.25, 0.25});
  EXPECT_TRUE(grid.contains(40));
  EXPECT_FALSE(grid.contains(8));
  EXPECT_EQ(grid.size(), 2U);
  EXPECT_EQ(in_cell(grid, 0), (Agents{7, 40}));
}

TEST(PackedGrid, ReusesTheBlocksOfCellsThatEmptied) {
  PackedGrid grid = four_packed_cells();
  for (int round = 0; round < 100; ++round) {
    Vector const p = round % 2 == 0 ? Vector{0.25, 0.25} : Vector{0.75, 0.75};
    for (std::size_t agent = 0; agent < 50; ++agent) grid.contains(agent) ? grid.move(agent, p) : grid.insert(agent, p);
    ASSERT_TRUE(grid.is_consistent());
    ASSERT_EQ(in_cell(grid, round % 2 == 0 ? 0 : 3).size(), 50U);
  }
}

TEST(PackedGrid, CountsPointsOutsideTheBoxToTheNearestCellHoweverFar) {
  PackedGrid grid = four_packed_cells();
  grid.insert(0, {-1e9, 0.25});
  grid.insert(1, {1e300, 1e300});
  EXPECT_EQ(in_cell(grid, 0), (Agents{0}));
  EXPECT_EQ(in_cell(grid, 3), (Agents{1}));
  EXPECT_TRUE(grid.is_consistent());
}

TEST(PackedGrid, ACopyIsAGridOfItsOwn) {
  PackedGrid grid = four_packed_cells();
  for (std::size_t agent = 0; agent < 9; ++agent) grid.insert(agent, {0.25, 0.25});
  PackedGrid copy = grid;
  copy.erase(3);
  EXPECT_TRUE(grid.contains(3));
  EXPECT_TRUE(grid.is_consistent());
  EXPECT_TRUE(copy.is_consistent());
}

TEST(PackedGrid, RefusesMoreCellsThanItsBlocksCanBeNumbered) {
  EXPECT_THROW(PackedGrid(CellLayout(Box(1.0, 1.0, Edge::wall), 40000, 40000)), Error);
}

TEST(PackedGrid, NearSlotsAreThoseWithinTheLimit) {
  PackedGrid::Block block{.x = {0.1F, 0.5F, 1e18F, -2.0F},
                          .y = {0.1F, 0.5F, 1e18F, 0.0F},
                          .agent = {},
                          .next = PackedGrid::none,
                          .count = 4,
                          .marks = 0,
                          .column = 0,
                          .row = 0};
  EXPECT_EQ(PackedGrid::near_bits(block, {0.1F, 0.2F}, 0.011F), 0b0001U);
  EXPECT_EQ(PackedGrid::near_bits(block, {0.1F, 0.2F}, 0.5F), 0b0011U);
}

TEST(PackedGrid, MarksStayWithTheirAgentsWhileThoseMoveThroughCrowdedCells) {
  // 40 agents in 3 × 3 cells: chains of blocks grow and shrink all the time.
  CellLayout const layout(Box(1.0, 1.0, Edge::wall), 3, 3);
  RandomStream random(7, 0, 0, Purpose::start_position);
  PackedGrid grid(layout);
  auto const& seen = std::as_const(grid);
  std::vector<bool> is_marked(40, false);
  for (std::size_t i = 0; i < is_marked.size(); ++i) grid.insert(i, {random.uniform(), random.uniform()});
  for (int n = 0; n < 2000; ++n) {
    std::size_t const i = random.below(is_marked.size());
    if (random.below(2) == 0) {
      grid.block_of(i).marks ^= static_cast<std::uint16_t>(1U << grid.slot_of(i));
      is_marked[i] = !is_marked[i];
    } else {
      grid.move(i, {random.uniform(), random.uniform()});
    }
    ASSERT_TRUE(grid.is_consistent());
    for (std::size_t k = 0; k < is_marked.size(); ++k) {
      ASSERT_EQ(((seen.block_of(k).marks >> seen.slot_of(k)) & 1U) != 0, is_marked[k]) << "agent " << k;
    }
  }
}

TEST(PackedGrid, MarksTheCellsThatAgentsComeIntoOrLeave) {
  PackedGrid grid = four_packed_cells();
  for (std::size_t agent = 0; agent < 9; ++agent) grid.insert(agent, {0.25, 0.25});
  auto const changed = [&grid] {
    std::vector<int> cells;
    for (int cell = 0; cell < 4; ++cell) {
      PackedGrid::Block& block = grid.block_at(cell % 2, cell / 2);
      if ((block.marks & PackedGrid::changed) != 0) cells.push_back(cell);
      block.marks &= static_cast<std::uint16_t>(~PackedGrid::changed);
    }
    return cells;
  };
  EXPECT_EQ(changed(), (std::vector<int>{0}));
  grid.move(8, {0.3, 0.3});
  EXPECT_EQ(changed(), (std::vector<int>{}));
  grid.move(2, {0.75, 0.75});
  EXPECT_EQ(changed(), (std::vector<int>{0, 3}));
  grid.erase(2);
  EXPECT_EQ(changed(), (std::vector<int>{3}));
  grid.rename(8, 2);
  EXPECT_EQ(changed(), (std::vector<int>{0}));
}

TEST(PackedGrid, AgentsOnTheEdgesOfCellsAreWhereTheLayoutSaysTheyAre) {
  for (int const columns : {1, 3, 7, 49}) {
    CellLayout const layout(Box(1.0, 2.0, Edge::periodic), columns, 2 * columns + 1);
    PackedGrid grid(layout);
    grid.insert(0, {0.5, 0.5});
    for (int c = 0; c <= columns; ++c) {
      double const edge = static_cast<double>(c) / columns;
      for (double const x : {std::nextafter(edge, 0.0), edge, std::nextafter(edge, 1.0)}) {
        // From the cell on the left, from the one on the right, and from within.
        for (double const from : {edge - 0.5 / columns, edge + 0.5 / columns, x}) {
          grid.move(0, {std::clamp(from, 0.0, 1.0), 2.0 * edge});
          grid.move(0, {x, 2.0 * x});
          ASSERT_EQ(grid.cell_of(0), layout.cell_of({x, 2.0 * x})) << columns << " columns, x = " << x;
          ASSERT_TRUE(grid.is_consistent());
        }
      }
    }
  }
}

/// Whatever lies in the window is where the whole box has it, and the rest seems empty.
void expect_window_of_whole(Edge edge, CellWindow const& window) {
  CellLayout const layout(Box(12.0, 9.0, edge), 12, 9);
  PackedGrid whole(layout, 200);
  PackedGrid part(layout, window, 200);
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (std::size_t i = 0; i < 200; ++i) {
    double const x = 12.0 * random.uniform();
    Vector const p{x, 9.0 * random.uniform()};
    whole.insert(i, p);
    if (part.stores(layout.column_of(p.x), layout.row_of(p.y))) part.insert(i, p);
  }
  ASSERT_TRUE(part.is_consistent());
  ASSERT_GT(part.size(), 0U);
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 12; ++column) {
      int const cell = row * 12 + column;
      EXPECT_EQ(in_cell(part, cell), part.stores(column, row) ? in_cell(whole, cell) : Agents{});
    }
  }
}

TEST(PackedGrid, StoresAWindowOfTheCellsUnderTheNumbersOfTheWholeBox) {
  expect_window_of_whole(Edge::wall, {.first_column = 3, .end_column = 7, .first_row = 2, .end_row = 9});
  expect_window_of_whole(Edge::periodic, {.first_column = -2, .end_column = 5, .first_row = -1, .end_row = 4});
  expect_window_of_whole(Edge::periodic, {.first_column = 8, .end_column = 14, .first_row = 6, .end_row = 11});
  expect_window_of_whole(Edge::periodic, {.first_column = -3, .end_column = 12, .first_row = 0, .end_row = 3});
}

TEST(PackedGrid, TheCellsBesideOneInAWindowAreThoseOfTheBox) {
  CellLayout const layout(Box(12.0, 9.0, Edge::periodic), 12, 9);
  PackedGrid const grid(layout, {.first_column = -1, .end_column = 5, .first_row = 7, .end_row = 10}, 1);
  EXPECT_EQ(grid.block_at(grid.column_left_of(0), 8).column, 11);
  EXPECT_EQ(grid.block_at(0, grid.row_above(8)).row, 0);
  PackedGrid const at_wall(CellLayout(Box(12.0, 9.0, Edge::wall), 12, 9),
                           {.first_column = 0, .end_column = 5, .first_row = 7, .end_row = 9}, 1);
  EXPECT_EQ(at_wall.block_at(at_wall.column_left_of(0), 8).count, 0);
  EXPECT_EQ(at_wall.block_at(at_wall.column_left_of(0), 8).column, 12);
  EXPECT_EQ(at_wall.block_at(1, at_wall.row_above(8)).row, 9);
}

}  // namespace
}  // namespace gridlock
