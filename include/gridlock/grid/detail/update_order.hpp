#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// The agents of a tile that have not had their turn, in the order of their turns: class by class of cells three apart
/// in both directions, and in a class first the agents with the lowest Id of every cell, then the second lowest, …
///
///     classes    6 7 8 6 7 8     The agents of one class and one level have no neighbour in common, so their turns
///     of cells:  3 4 5 3 4 5     can be prepared together before any of them is taken.
///                0 1 2 0 1 2
///
/// Agents that come into a tile from another have had their turns, and those that have not stay where they are, so the
/// list made at the beginning stays right.
class UpdateOrder {
 public:
  static constexpr std::size_t classes = 9;

  /// Finds those of the tile. `ids` are the Ids of all rows, or numbers in the same order; take_pending(block), called
  /// once for each block, has bit s set where the agent in slot s has not had its turn.
  template <class Grid, class Ids, class TakePending>
  void find(Grid& grid, Tiling::Tile const& tile, Ids const& ids, TakePending take_pending) {
    auto const third = [](int cells) { return static_cast<std::size_t>((cells + 2) / 3); };
    clear(third(tile.end_column - tile.first_column) * third(tile.end_row - tile.first_row));
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      add_row(static_cast<std::size_t>(3 * ((row - tile.first_row) % 3)), grid, tile, row, take_pending);
    }
    sort_cells(ids);
  }

  /// Calls visit(rows) for every class and level, in the order of the turns.
  template <class Visit>
  void for_each_group(Visit visit) const {
    for (std::vector<Level> const& levels : classes_) {
      for (Level const& level : levels) {
        if (level.size > 0) visit(std::span(level.rows).first(level.size));
      }
    }
  }

 private:
  void clear(std::size_t cells_of_class) {
    crowded_size_ = 0;
    chains_.clear();
    if (crowded_.size() < classes * cells_of_class + 1) crowded_.resize(classes * cells_of_class + 1);
    for (std::vector<Level>& levels : classes_) {
      for (Level& level : levels) {
        level.size = 0;
        if (level.rows.size() < cells_of_class + 1) level.rows.resize(cells_of_class + 1);
      }
      while (levels.size() < PackedGrid::slots)
        levels.push_back({.rows = std::vector<std::uint32_t>(cells_of_class + 1)});
    }
  }

  /// Adds the agents of a row of cells to three classes in turns. Which they are is as good as random, so nothing
  /// depends on it but what is written. Cells in which several wait are left for sort_cells().
  template <class Grid, class TakePending>
  void add_row(std::size_t first_class, Grid& grid, Tiling::Tile const& tile, int row, TakePending take_pending) {
    // Kept out of memory, where one cell would wait for what the one before has written.
    Crowded* crowded = crowded_.data() + crowded_size_;
    auto const level = [&](std::size_t k) -> Level& { return classes_[first_class + k][0]; };
    std::array<std::uint32_t*, 3> const rows{level(0).rows.data(), level(1).rows.data(), level(2).rows.data()};
    std::array<std::size_t, 3> size{level(0).size, level(1).size, level(2).size};
    auto const add = [&](int column, std::size_t k) {
      auto& block = grid.block_at(column, row);
      unsigned slots_set = 0;
      if (block.next == PackedGrid::none) [[likely]] {
        slots_set = take_pending(block);
        rows[k][size[k]] = block.agent[first_of(slots_set | last_slot)];
      } else {
        slots_set = add_chain(grid, block, take_pending);
      }
      *crowded = {&block, static_cast<std::uint32_t>(size[k]), static_cast<std::uint16_t>(first_class + k),
                  static_cast<std::uint16_t>(slots_set)};
      crowded += several[slots_set];
      size[k] += any[slots_set];
    };
    int column = tile.first_column;
    for (; column + 3 <= tile.end_column; column += 3) {
      add(column, 0);
      add(column + 1, 1);
      add(column + 2, 2);
    }
    if (column < tile.end_column) add(column, 0);
    if (column + 1 < tile.end_column) add(column + 1, 1);
    crowded_size_ = static_cast<std::size_t>(crowded - crowded_.data());
    for (std::size_t k = 0; k < 3; ++k) level(k).size = size[k];
  }

  /// Adds the agents that wait in a cell of several blocks. Returns `chain`, or 0 where nobody waits.
  template <class Grid, class Block, class TakePending>
  [[gnu::noinline]] unsigned add_chain(Grid& grid, Block& first, TakePending take_pending) {
    std::vector<std::uint32_t> rows;
    for (Block* block = &first;; block = &grid.next_of(*block)) {
      for (unsigned left = take_pending(*block); left != 0; left &= left - 1) {
        rows.push_back(block->agent[first_of(left)]);
      }
      if (block->next == PackedGrid::none) break;
    }
    if (rows.empty()) return 0;
    chains_.push_back(std::move(rows));
    return chain;
  }

  /// After the last cell: puts the agents of one cell in the order of their Ids.
  template <class Ids>
  void sort_cells(Ids const& ids) {
    auto next_chain = chains_.begin();
    for (Crowded const& cell : std::span(crowded_).first(crowded_size_)) {
      if (cell.slots_set == chain) {
        std::ranges::sort(*next_chain, {}, [&](std::uint32_t i) { return ids[i]; });
        place_rows(cell, *next_chain++);
        continue;
      }
      std::array<std::uint32_t, PackedGrid::slots> rows;
      std::size_t count = 0;
      for (unsigned left = cell.slots_set; left != 0; left &= left - 1)
        rows[count++] = cell.block->agent[first_of(left)];
      order(rows[0], rows[1], ids);
      if (count > 2) {
        for (std::size_t n = 2; n < count; ++n) {
          for (std::size_t k = n; k > 0; --k) order(rows[k - 1], rows[k], ids);
        }
      }
      place_rows(cell, std::span<std::uint32_t const>(rows).first(count));
    }
  }

  struct Level {
    std::vector<std::uint32_t> rows;  ///< one more than can be: for what is written and not meant
    std::size_t size = 0;
  };
  /// A cell in whose block several agents wait, or one of several blocks; in level 0 it has the place `place`.
  struct Crowded {
    PackedGrid::Block const* block;
    std::uint32_t place;
    std::uint16_t of_class;
    std::uint16_t slots_set;
  };
  /// The rows of one cell to the levels of its class.
  void place_rows(Crowded const& cell, std::span<std::uint32_t const> rows) {
    std::vector<Level>& levels = classes_[cell.of_class];
    while (levels.size() < rows.size()) levels.push_back({.rows = std::vector<std::uint32_t>(levels[0].rows.size())});
    levels[0].rows[cell.place] = rows[0];
    for (std::size_t n = 1; n < rows.size(); ++n) levels[n].rows[levels[n].size++] = rows[n];
  }

  // 1 where a set of slots has any, or several. Looked up, because a compiler makes a branch of a question.
  static constexpr std::array<std::uint8_t, (1U << PackedGrid::slots) + 1> any{0, 1, 1, 1, 1, 1, 1, 1, 1,
                                                                               1, 1, 1, 1, 1, 1, 1, 1};
  static constexpr std::array<std::uint8_t, (1U << PackedGrid::slots) + 1> several{0, 0, 0, 1, 0, 1, 1, 1, 0,
                                                                                   1, 1, 1, 1, 1, 1, 1, 1};
  /// Stands for the slots of a cell of several blocks in which somebody waits.
  static constexpr unsigned chain = 1U << PackedGrid::slots;
  static constexpr unsigned last_slot = 1U << (PackedGrid::slots - 1);

  static std::size_t first_of(unsigned slots_set) { return static_cast<std::size_t>(std::countr_zero(slots_set)); }

  template <class Ids>
  static void order(std::uint32_t& low, std::uint32_t& high, Ids const& ids) {
    std::uint32_t const a = low;
    std::uint32_t const b = high;
    std::uint32_t const swap = (a ^ b) & -static_cast<std::uint32_t>(ids[b] < ids[a]);
    low = a ^ swap;
    high = b ^ swap;
  }

  std::array<std::vector<Level>, classes> classes_;
  std::vector<Crowded> crowded_;                    ///< one more than can be
  std::vector<std::vector<std::uint32_t>> chains_;  ///< who waits in cells of several blocks
  std::size_t crowded_size_ = 0;
};

}  // namespace gridlock
