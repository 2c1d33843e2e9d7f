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
