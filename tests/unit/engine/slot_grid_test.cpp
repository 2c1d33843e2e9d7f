#include "engine/exact/slot_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <vector>

#include "gridlock/core/random.hpp"

namespace gridlock::exact {
namespace {

std::vector<Index> disks_in(SlotGrid const& grid, std::int32_t column, std::int32_t row) {
  Index const* const cell = grid.slots_of(column, row);
  std::vector<Index> found;
  for (std::size_t k = 0; k < grid.capacity(); ++k) {
    if (cell[k] != no_disk) found.push_back(cell[k]);
  }
  return found;
}

TEST(SlotGrid, HoldsWhatASetHoldsInTheFirstSlotsOfEachCellAndOfItsGhosts) {
  constexpr std::int32_t side = 3;
  Box const box(3.0, 3.0, Edge::periodic);
  SlotGrid grid(CellLayout(box, side, side), box);
  std::vector<std::set<Index>> expected(side * side);
  RandomStream random(7, 0, 0, Purpose::start_position);
  for (int step = 0; step < 3000; ++step) {
    auto const disk = static_cast<Index>(random.uniform() * 40);
    auto const place =
        std::ranges::find_if(expected, [&](auto const& in_cell) { return in_cell.contains(disk); }) - expected.begin();
    if (place < side * side) {
      grid.erase(disk, static_cast<std::int32_t>(place) % side, static_cast<std::int32_t>(place) / side);
      expected[static_cast<std::size_t>(place)].erase(disk);
    } else {
      auto const cell = static_cast<std::int32_t>(random.uniform() * side * side);
      grid.insert(disk, cell % side, cell / side);
      expected[static_cast<std::size_t>(cell)].insert(disk);
    }
    for (std::int32_t row = -1; row <= side; ++row) {
      for (std::int32_t column = -1; column <= side; ++column) {
        auto const original = static_cast<std::size_t>((row + side) % side * side + (column + side) % side);
        std::vector<Index> const found = disks_in(grid, column, row);
        ASSERT_EQ(std::set<Index>(found.begin(), found.end()), expected[original]) << "step " << step;
        ASSERT_TRUE(found.empty() || grid.slots_of(column, row)[found.size() - 1] != no_disk)
            << "a hole in cell " << column << ", " << row << " at step " << step;
      }
    }
  }
  EXPECT_GT(grid.capacity(), 4U) << "no cell ran full: the test does not see the slots double";
}

/// Within the limits of cells with one between them, no two disks are as near as the reach.
void expect_far_apart(double const* limits, std::int32_t cells, double reach) {
  for (std::int32_t k = 0; k + 2 < cells; ++k) EXPECT_GT(limits[2 * (k + 2)] - limits[2 * k + 1], reach);
}

TEST(SlotGrid, LetsDisksLeaveTheirCellAsFarAsTheyStillMeetNobodyElse) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(7.0, 4.0, edge);
    CellLayout const layout(box, 7, 5);
    for (double const reach : {0.1, 0.5, 0.79, 0.8, 0.95, 1.0, 3.0}) {
      SlotGrid const grid(layout, box, reach);
      expect_far_apart(grid.column_limits(), 7, std::min(reach, 1.0 - 1e-12));
      expect_far_apart(grid.row_limits(), 5, std::min(reach, 0.8 - 1e-12));
      EXPECT_EQ(grid.column_limits()[0], 0.0);
      EXPECT_EQ(grid.column_limits()[13], 7.0);
      EXPECT_EQ(grid.row_limits()[0], 0.0);
      EXPECT_EQ(grid.row_limits()[9], 4.0);
      EXPECT_NEAR(grid.largest_margin(), std::max(0.0, 0.5 * (1.0 - reach)), 1e-5);
      EXPECT_NEAR(grid.column_limits()[5], 3.0 + grid.largest_margin(), 1e-12);
      EXPECT_NEAR(grid.column_limits()[6], 3.0 - grid.largest_margin(), 1e-12);
    }
    SlotGrid const without(layout, box);
    EXPECT_EQ(without.largest_margin(), 0.0);
    EXPECT_EQ(without.column_limits()[5], without.column_limits()[6]);
  }
}

TEST(SlotGrid, SaysWhichCellsAreFull) {
  Box const box(7.0, 4.0, Edge::wall);
  SlotGrid grid(CellLayout(box, 7, 4), box);
  for (Index disk = 0; disk < 4; ++disk) {
    EXPECT_FALSE(grid.is_full(2, 3));
    grid.insert(disk, 2, 3);
  }
  EXPECT_TRUE(grid.is_full(2, 3));
  EXPECT_FALSE(grid.is_full(3, 3));
  grid.erase(1, 2, 3);
  EXPECT_FALSE(grid.is_full(2, 3));
}

TEST(SlotGrid, VisitsEachDiskOfTheCellsOfARectangleOnce) {
  RandomStream random(8, 0, 0, Purpose::start_position);
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    Box const box(7.0, 4.0, edge);
    CellLayout const layout(box, 7, 4);
    SlotGrid grid(layout, box);
    std::vector<Vector> places;
    for (Index i = 0; i < 100; ++i) {
      places.push_back({7.0 * random.uniform(), 4.0 * random.uniform()});
      grid.insert(i, grid.column_of(places[i].x), grid.row_of(places[i].y));
    }
    for (int search = 0; search < 1000; ++search) {
      Vector const lower{-3.0 + 12.0 * random.uniform(), -3.0 + 9.0 * random.uniform()};
      Vector const upper = lower + Vector{9.0 * random.uniform(), 5.0 * random.uniform()};
      std::vector<Index> found;
      grid.for_each_run(lower, upper, [&](std::span<Index const> slots) {
        std::ranges::copy_if(slots, std::back_inserter(found), [](Index i) { return i != no_disk; });
      });
      std::ranges::sort(found);
      EXPECT_EQ(std::ranges::adjacent_find(found), found.end()) << "visited twice";
      auto const is_inside = [&](double x, double from, double to, double side) {
        bool is_any = x >= from && x <= to;
        for (double const shift : {-2.0 * side, -side, side, 2.0 * side}) {
          is_any |= edge == Edge::periodic && x + shift >= from && x + shift <= to;
        }
        return is_any;
      };
      for (Index i = 0; i < places.size(); ++i) {
        if (!is_inside(places[i].x, lower.x, upper.x, 7.0) || !is_inside(places[i].y, lower.y, upper.y, 4.0)) continue;
        EXPECT_TRUE(std::ranges::binary_search(found, i)) << "disk " << i << " is missing";
      }
    }
  }
}

}  // namespace
}  // namespace gridlock::exact
