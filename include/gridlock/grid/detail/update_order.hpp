#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// The agents of a tile that have not had their turn, in the order of their turns: class by class of cells three apart in
/// both directions, and in a class first the agents with the lowest Id of every cell, then the second lowest, …
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

  /// Finds those of the tile. `ids` are the Ids of all rows, or numbers in the same order; pending_slots(block) has bit s
  /// set where the agent in slot s has not had its turn.
  template <class Number, class PendingSlots>
  void find(PackedGrid const& grid, Tiling::Tile const& tile, std::vector<Number> const& ids,
            PendingSlots pending_slots) {
    auto const third = [](int cells) { return static_cast<std::size_t>((cells + 2) / 3); };
    clear(third(tile.end_column - tile.first_column) * third(tile.end_row - tile.first_row));
    auto const in_chain = [&](PackedGrid::Block const& first) {
      return rows_in_chain(grid, first, ids, pending_slots);
    };
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int k = 0; k < 3; ++k) {
        auto const of_class = static_cast<std::size_t>(3 * ((row - tile.first_row) % 3) + k);
        add_cells(of_class, grid, tile.first_column + k, tile.end_column, row, pending_slots, in_chain);
      }
    }
    sort_cells(ids, in_chain);
  }

  /// Agents that wait.
  [[nodiscard]] std::size_t size() const { return size_; }

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
  /// The agents of a cell of any size that wait, in the order of their Ids.
  template <class Number, class PendingSlots>
  static std::vector<std::uint32_t> rows_in_chain(PackedGrid const& grid, PackedGrid::Block const& first,
                                                  std::vector<Number> const& ids, PendingSlots pending_slots) {
    std::vector<std::uint32_t> rows;
    for (PackedGrid::Block const* block = &first;; block = &grid.next_of(*block)) {
      for (unsigned left = pending_slots(*block); left != 0; left &= left - 1) {
        rows.push_back(block->agent[first_of(left)]);
      }
      if (block->next == PackedGrid::none) break;
    }
    std::ranges::sort(rows, {}, [&](std::uint32_t i) { return ids[i]; });
    return rows;
  }

  void clear(std::size_t cells_of_class) {
    size_ = 0;
    crowded_size_ = 0;
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

  /// Adds the agents of every third cell of a row. Which they are is as good as random, so nothing depends on it but what is
  /// written. Cells in which several wait are left for sort_cells().
  template <class PendingSlots, class InChain>
  void add_cells(std::size_t of_class, PackedGrid const& grid, int first_column, int end_column, int row,
                 PendingSlots pending_slots, InChain in_chain) {
    Level& level = classes_[of_class][0];
    // Kept out of memory, where one cell would wait for what the one before has written.
    std::uint32_t* const rows = level.rows.data();
    Crowded* crowded = crowded_.data() + crowded_size_;
    std::size_t const size_before = level.size;
    std::size_t size = size_before;
    for (int column = first_column; column < end_column; column += 3) {
      PackedGrid::Block const& block = grid.block_at(column, row);
      unsigned slots_set = 0;
      if (block.next == PackedGrid::none) [[likely]] {
        slots_set = pending_slots(block);
        rows[size] = block.agent[first_of(slots_set | last_slot)];
      } else if (in_chain(block).empty()) {
        continue;
      } else {
        slots_set = chain;
      }
      *crowded = {&block, static_cast<std::uint32_t>(size), static_cast<std::uint16_t>(of_class),
                  static_cast<std::uint16_t>(slots_set)};
      crowded += several[slots_set];
      size += any[slots_set];
    }
    crowded_size_ = static_cast<std::size_t>(crowded - crowded_.data());
    level.size = size;
    size_ += size - size_before;
  }

  /// After the last cell: puts the agents of one cell in the order of their Ids. in_chain(first block) returns the rows of a
  /// chain in this order.
  template <class Number, class InChain>
  void sort_cells(std::vector<Number> const& ids, InChain in_chain) {
    for (Crowded const& cell : std::span(crowded_).first(crowded_size_)) {
      if (cell.slots_set == chain) {
        place_rows(cell, in_chain(*cell.block));
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
    std::vector<std::uint32_t> rows;  ///< one more than can be, for what is written and not meant
    std::size_t size = 0;
  };
  /// A cell in whose block several agents wait; in level 0 it has the place `place`.
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
    size_ += rows.size() - 1;
  }

  // Of a set of slots: 1 where there is any in it, or several. Looked up, because a compiler makes a branch of a question.
  static constexpr std::array<std::uint8_t, (1U << PackedGrid::slots) + 1> any{0, 1, 1, 1, 1, 1, 1, 1, 1,
                                                                               1, 1, 1, 1, 1, 1, 1, 1};
  static constexpr std::array<std::uint8_t, (1U << PackedGrid::slots) + 1> several{0, 0, 0, 1, 0, 1, 1, 1, 0,
                                                                                   1, 1, 1, 1, 1, 1, 1, 1};
  /// Stands for the slots of a cell of several blocks in which somebody waits.
  static constexpr unsigned chain = 1U << PackedGrid::slots;
  static constexpr unsigned last_slot = 1U << (PackedGrid::slots - 1);

  static std::size_t first_of(unsigned slots_set) { return static_cast<std::size_t>(std::countr_zero(slots_set)); }

  template <class Number>
  static void order(std::uint32_t& low, std::uint32_t& high, std::vector<Number> const& ids) {
    std::uint32_t const a = low;
    std::uint32_t const b = high;
    std::uint32_t const swap = (a ^ b) & -static_cast<std::uint32_t>(ids[b] < ids[a]);
    low = a ^ swap;
    high = b ^ swap;
  }

  std::array<std::vector<Level>, classes> classes_;
  std::vector<Crowded> crowded_;  ///< one more than can be
  std::size_t crowded_size_ = 0;
  std::size_t size_ = 0;
};

}  // namespace gridlock
