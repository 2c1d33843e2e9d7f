#include "gridlock/grid/detail/class_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {
namespace {

using Rows = std::vector<std::uint32_t>;

constexpr std::size_t largest_batch = 16;

/// The order as the engine tiled finds it, whose blocks remember who has had a
/// turn.
template <class Ids>
void find_order(ClassOrder& order, PackedGrid& grid, Tiling const& tiling, std::span<std::uint32_t const> tiles,
                std::size_t of_class, Ids const& ids, unsigned turned) {
  auto const id_of = [&](std::uint32_t row) { return ids[row]; };
  order.find(grid, tiling, tiles, of_class, id_of, [&](PackedGrid::Block& block) {
    unsigned const marks = block.marks;
    block.marks = static_cast<std::uint16_t>((marks & ~WaitingInBlock::all_slots) | turned);
    return marks ^ turned;
  });
}

/// Points at random in a grid that take turns step after step; in its turn a
/// point goes to any place in the cells around its own.
class Turns {
 public:
  Turns(std::size_t count, std::uint64_t seed, double mobile_part)
      : random_(seed, 1, 0, Purpose::start_position), mobile_part_(mobile_part), ids_(count), points_(count) {
    std::iota(ids_.begin(), ids_.end(), 0U);
    for (std::size_t k = count; k > 1; --k) std::swap(ids_[k - 1], ids_[random_.below(k)]);
    for (std::uint32_t k = 0; k < count; ++k) {
      points_[k] = {random_.uniform(), random_.uniform()};
      grid_.insert(k, points_[k]);
    }
  }

  void begin_step() { turned_ ^= WaitingInBlock::all_slots; }

  /// The order of each of the tiles alone, as it is defined: class by class,
  /// level by level, cell by cell.
  [[nodiscard]] std::vector<Rows> expected(std::span<std::uint32_t const> tiles) const {
    std::vector<Rows> orders;
    for (std::uint32_t const tile : tiles) {
      orders.emplace_back();
      for (int of_class = 0; of_class < 9; ++of_class) add_class(tiling_.tiles()[tile], of_class, orders.back());
    }
    return orders;
  }

  /// The turns of the tiles together. Returns what each tile does, in its
  /// order.
  std::vector<Rows> take(ClassOrder& order, std::span<std::uint32_t const> tiles) {
    std::vector<Rows> taken(tiles.size());
    for (std::size_t of_class = 0; of_class < ClassOrder::classes; ++of_class) {
      find_order(order, grid_, tiling_, tiles, of_class, ids_, turned_);
      for (std::size_t first = 0; first < order.size();) {
        std::size_t const end = order.next_batch(grid_, first, largest_batch);
        EXPECT_GT(end, first);
        EXPECT_LE(end, first + largest_batch);
        require_apart(order, first, end);
        for (std::size_t k = first; k < end; ++k) {
          std::uint32_t const row = order.rows()[k];
          EXPECT_EQ(order.blocks()[k], &grid_.block_of(row));
          EXPECT_EQ(order.slots()[k], grid_.slot_of(row));
          taken.at(order.tiles()[k]).push_back(row);
        }
        for (std::size_t k = end; k < order.size() + ClassOrder::beyond; ++k)
          EXPECT_LT(order.rows()[k], points_.size());
        for (std::size_t k = first; k < end; ++k) go(order.rows()[k]);
        sizes_of_batches.push_back(end - first);
        first = end;
      }
    }
    return taken;
  }

  [[nodiscard]] Tiling const& tiling() const { return tiling_; }
  [[nodiscard]] std::size_t further_blocks() const { return grid_.further_blocks(); }

  std::vector<std::size_t> sizes_of_batches;

 private:
  void add_class(Tiling::Tile const& tile, int of_class, Rows& order) const {
    std::vector<Rows> cells;
    for (int row = tile.first_row + of_class / 3; row < tile.end_row; row += 3) {
      for (int column = tile.first_column + of_class % 3; column < tile.end_column; column += 3)
        cells.push_back(waiting_in(row * layout_.columns() + column));
    }
    for (std::size_t level = 0, before = order.size() + 1; before != order.size(); ++level) {
      before = order.size();
      for (Rows const& cell : cells) {
        if (level < cell.size()) order.push_back(cell[level]);
      }
    }
  }
  /// In the order of the Ids.
  [[nodiscard]] Rows waiting_in(int cell) const {
    Rows rows;
    grid_.for_each_in_cell(cell, [&](std::size_t row) {
      bool const waits = ((grid_.block_of(row).marks ^ turned_) >> grid_.slot_of(row) & 1U) != 0;
      if (waits) rows.push_back(static_cast<std::uint32_t>(row));
    });
    std::ranges::sort(rows, {}, [&](std::uint32_t row) { return ids_[row]; });
    return rows;
  }
  void require_apart(ClassOrder const& order, std::size_t first, std::size_t end) const {
    std::vector<int> cells;
    for (std::size_t k = first; k < end; ++k) cells.push_back(grid_.cell_of(order.rows()[k]));
    std::ranges::sort(cells);
    EXPECT_EQ(std::ranges::adjacent_find(cells), cells.end()) << "two of one cell are in a batch";
  }

  void go(std::uint32_t row) {
    if (random_.uniform() > mobile_part_) return;
    auto const near = [this](double p, double cell) {
      return std::clamp(p + (2.0 * random_.uniform() - 1.0) * cell, 0.0, 0.999999);
    };
    points_[row] = {near(points_[row].x, layout_.cell_width()), near(points_[row].y, layout_.cell_height())};
    grid_.move(row, points_[row]);
  }

  CellLayout layout_{Box(1.0, 1.0, Edge::wall), 79, 75};
  Tiling tiling_{layout_};
  PackedGrid grid_{layout_, 0};
  RandomStream random_;
  double mobile_part_;
  std::vector<std::uint32_t> ids_;
  std::vector<Vector> points_;
  unsigned turned_ = 0;
};

/// Takes the turns of all tiles, some of a colour together; each has its own
/// order.
void take_step(Turns& turns, ClassOrder& order, std::size_t most) {
  turns.begin_step();
  Rows all(turns.tiling().tiles().size());
  std::iota(all.begin(), all.end(), 0U);
  for (std::span<std::uint32_t const> rest = all; !rest.empty();) {
    std::span<std::uint32_t const> const tiles = turns.tiling().first_team(rest, most);
    std::vector<Rows> const expected = turns.expected(tiles);
    ASSERT_EQ(turns.take(order, tiles), expected);
    rest = rest.subspan(tiles.size());
  }
}

/// Sparse points, some to a cell, and so many that nearly every cell has
/// several blocks.
constexpr std::array<std::size_t, 4> numbers_of_points{40, 4000, 12'000, 60'000};

TEST(ClassOrder, IsThatOfEachTileAloneStepAfterStep) {
  ClassOrder order;
  for (std::size_t const count : numbers_of_points) {
    for (std::size_t tiles = 1; tiles <= Tiling::tiles_of_team; ++tiles) {
      Turns turns(count, count + tiles, 0.2 * static_cast<double>(tiles));
      for (int step = 0; step < 5; ++step) take_step(turns, order, tiles);
      EXPECT_EQ(turns.further_blocks() > 1000, count == numbers_of_points.back());
    }
  }
}

TEST(ClassOrder, FillsBatchesAcrossLevels) {
  Turns turns(12'000, 1, 0.1);
  ClassOrder order;
  take_step(turns, order, Tiling::tiles_of_team);
  std::size_t const full = static_cast<std::size_t>(std::ranges::count(turns.sizes_of_batches, largest_batch));
  EXPECT_GT(full * largest_batch, 12'000U * 3 / 4);
}

TEST(ClassOrder, KnowsTheOrderOfAnyIdsInABlock) {
  std::array<std::uint32_t, PackedGrid::slots> ids{0, 1, 2, 3};
  do {
    for (std::uint32_t count = 0; count <= PackedGrid::slots; ++count) {
      CellLayout const layout(Box(1.0, 1.0, Edge::wall), 1, 1);
      PackedGrid grid(layout, count);
      for (std::uint32_t k = 0; k < count; ++k) grid.insert(k, {0.1 + 0.2 * k, 0.5});
      ClassOrder order;
      std::uint32_t const tile = 0;
      Tiling const tiling(layout);
      for (unsigned const turned : {15U, 0U, 15U}) {
        find_order(order, grid, tiling, std::span(&tile, 1), 0, ids, turned);
        ASSERT_EQ(order.size(), count);
        for (std::size_t k = 1; k < count; ++k) ASSERT_LT(ids[order.rows()[k - 1]], ids[order.rows()[k]]);
        find_order(order, grid, tiling, std::span(&tile, 1), 0, ids, turned);
        EXPECT_EQ(order.size(), 0U) << "they have had their turns";
      }
    }
  } while (std::ranges::next_permutation(ids).found);
}

}  // namespace
}  // namespace gridlock
