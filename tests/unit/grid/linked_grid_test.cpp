#include "grid/linked_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace gridlock {
namespace {

std::vector<std::size_t> in_cell(LinkedGrid const& grid, int cell) {
  std::vector<std::size_t> agents;
  grid.for_each_in_cell(cell, [&](std::size_t agent) { agents.push_back(agent); });
  std::ranges::sort(agents);
  return agents;
}

std::vector<std::size_t> in_block(LinkedGrid const& grid, int cell, int cutoff) {
  std::vector<std::size_t> agents;
  grid.for_each_in_block(cell, cutoff, cutoff, [&](std::size_t agent) { agents.push_back(agent); });
  std::ranges::sort(agents);
  return agents;
}

using Agents = std::vector<std::size_t>;

LinkedGrid four_cells() { return LinkedGrid(CellLayout(Box(1.0, 1.0, Edge::wall), 2, 2)); }

TEST(LinkedGrid, StartsEmptyAndConsistent) {
  LinkedGrid const grid = four_cells();
  EXPECT_EQ(grid.size(), 0U);
  EXPECT_FALSE(grid.contains(0));
  EXPECT_TRUE(grid.is_consistent());
  EXPECT_EQ(in_block(grid, 0, 1), Agents{});
}

TEST(LinkedGrid, HoldsEveryPointItIsMadeOfInItsCell) {
  std::vector<double> const x{0.1, 0.9, 0.1, 0.9, 0.2};
  std::vector<double> const y{0.1, 0.1, 0.9, 0.9, 0.2};
  LinkedGrid const grid(CellLayout(Box(1.0, 1.0, Edge::wall), 2, 2), x, y);
  EXPECT_EQ(grid.size(), 5U);
  EXPECT_EQ(in_cell(grid, 0), (Agents{0, 4}));
  EXPECT_EQ(in_cell(grid, 1), (Agents{1}));
  EXPECT_EQ(in_cell(grid, 2), (Agents{2}));
  EXPECT_EQ(in_cell(grid, 3), (Agents{3}));
  EXPECT_TRUE(grid.is_consistent());
}

TEST(LinkedGrid, ErasesFirstMiddleAndLastOfAList) {
  for (std::size_t const gone : {0U, 1U, 2U}) {
    LinkedGrid grid = four_cells();
    for (std::size_t agent = 0; agent < 3; ++agent) grid.insert(agent, {0.1, 0.1});
    grid.erase(gone);
    Agents left{0, 1, 2};
    std::erase(left, gone);
    EXPECT_EQ(in_cell(grid, 0), left);
    EXPECT_FALSE(grid.contains(gone));
    EXPECT_EQ(grid.size(), 2U);
    EXPECT_TRUE(grid.is_consistent());
  }
}

TEST(LinkedGrid, TakesAnErasedAgentBackInAnotherCell) {
  LinkedGrid grid = four_cells();
  grid.insert(0, {0.1, 0.1});
  grid.erase(0);
  grid.insert(0, {0.9, 0.9});
  EXPECT_EQ(in_cell(grid, 0), Agents{});
  EXPECT_EQ(in_cell(grid, 3), Agents{0});
  EXPECT_TRUE(grid.is_consistent());
}

TEST(LinkedGrid, MovesAnAgentToTheListOfItsNewCell) {
  LinkedGrid grid = four_cells();
  for (std::size_t agent = 0; agent < 3; ++agent) grid.insert(agent, {0.1, 0.1});
  grid.move(1, {0.9, 0.1});
  EXPECT_EQ(in_cell(grid, 0), (Agents{0, 2}));
  EXPECT_EQ(in_cell(grid, 1), (Agents{1}));
  EXPECT_EQ(grid.cell_of(1), 1);
  EXPECT_EQ(grid.size(), 3U);
  grid.move(1, {0.6, 0.4});
  EXPECT_EQ(in_cell(grid, 1), (Agents{1})) << "a move within the cell changes nothing";
  EXPECT_TRUE(grid.is_consistent());
}

TEST(LinkedGrid, TakesAgentsInAnyOrderWithGaps) {
  LinkedGrid grid = four_cells();
  grid.insert(7, {0.1, 0.1});
  grid.insert(2, {0.1, 0.1});
  EXPECT_TRUE(grid.contains(7));
  EXPECT_FALSE(grid.contains(3));
  EXPECT_FALSE(grid.contains(8));
  EXPECT_EQ(in_cell(grid, 0), (Agents{2, 7}));
  EXPECT_TRUE(grid.is_consistent());
}

TEST(LinkedGrid, HoldsAnyNumberOfAgentsOnOnePoint) {
  LinkedGrid grid = four_cells();
  for (std::size_t agent = 0; agent < 100; ++agent) grid.insert(agent, {0.5, 0.5});
  EXPECT_EQ(in_cell(grid, 3).size(), 100U);
  EXPECT_EQ(in_block(grid, 0, 1).size(), 100U);
  for (std::size_t agent = 0; agent < 100; agent += 2) grid.move(agent, {0.4, 0.4});
  EXPECT_EQ(in_cell(grid, 0).size(), 50U);
  EXPECT_EQ(in_block(grid, 0, 0).size(), 50U);
  EXPECT_TRUE(grid.is_consistent());
}

TEST(LinkedGrid, VisitsEveryAgentOnceInBoxesOfOneTwoAndThreeCells) {
  std::vector<double> x;
  std::vector<double> y;
  for (int n = 0; n < 49; ++n) {
    x.push_back((n % 7) / 7.0);
    y.push_back((n / 7) / 7.0);
  }
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (std::uint64_t const cells : {std::uint64_t{1}, std::uint64_t{2}, std::uint64_t{3}}) {
      LinkedGrid const grid(CellLayout(Box(1.0, 1.0, edge), cells, cells), x, y);
      for (int cell = 0; cell < grid.layout().count(); ++cell) {
        Agents const found = in_block(grid, cell, 1);
        EXPECT_EQ(std::ranges::adjacent_find(found), found.end()) << "an agent came twice";
        bool const is_whole_box = edge == Edge::periodic || cells < 3 || cell == 4;
        EXPECT_EQ(found.size() == 49, is_whole_box) << cells << " cells a side, cell " << cell;
      }
    }
  }
}

#if !defined(NDEBUG)
TEST(LinkedGridDeathTest, AssertsItsContract) {
  LinkedGrid grid = four_cells();
  EXPECT_DEATH(grid.erase(0), "contains");
  EXPECT_DEATH(grid.move(0, {0.1, 0.1}), "contains");
  grid.insert(0, {0.1, 0.1});
  EXPECT_DEATH(grid.insert(0, {0.1, 0.1}), "outside");
}
#endif

}  // namespace
}  // namespace gridlock
