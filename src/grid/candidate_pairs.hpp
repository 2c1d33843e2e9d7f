#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {

/// A buffer of pairs for on_pairs. A processor cannot guess whether a candidate is a pair, and would stall at every
/// other one: so every candidate is written, and only the count depends on the comparison.
class PairBuffer {
 public:
  using Pair = AgentPair;
  /// Number of pairs that may be written behind the last valid one.
  static constexpr std::size_t slack = 16;
  /// Largest number of pairs that are kept before on_pairs is called.
  static constexpr std::size_t capacity = 1024;

  explicit PairBuffer(OnPairs const& on_pairs) : on_pairs_(on_pairs) {}

  /// Returns where to write the next pairs. At most `pairs` of them may be kept.
  Pair* room_for(std::size_t pairs) {
    if (size_ + pairs > capacity) flush();
    return pairs_.data() + size_;
  }
  /// Keeps the pairs that were written before `end`.
  void keep_until(Pair const* end) { size_ = static_cast<std::size_t>(end - pairs_.data()); }
  void flush() {
    on_pairs_({pairs_.data(), size_});
    size_ = 0;
  }

 private:
  alignas(64) std::array<Pair, capacity + slack> pairs_;
  std::size_t size_ = 0;
  OnPairs const& on_pairs_;
};

/// A block that the agents of a cell look at, and the shift of their positions that makes them relative to its cell.
struct SeenBlock {
  PackedGrid::Block const* block;
  float shift_x;
  float shift_y;
};

/// The half of a block of cells, to the right and above, that finds every pair once.
struct HalfBlock {
  PackedGrid const& grid;
  int reach_columns;
  int reach_rows;
  float limit;                       ///< PackedGrid::local_limit()
  std::vector<SeenBlock> seen = {};  ///< memory for blocks_seen_from()
};

// Columns and rows count from 0 in the window of the grid.

/// Returns the blocks of a cell, then those of the cells of its half block, in the order in which its agents look at
/// them. An agent looks at the later slots of its own block, and not at the blocks of its cell before that.
std::span<SeenBlock const> blocks_seen_from(HalfBlock& half, int column, int row);

/// Adds the candidate pairs of one cell.
void add_pairs_of_cell_scalar(HalfBlock& half, int column, int row, PairBuffer& buffer);

/// Largest number of blocks, beside its own, that an agent looks at in kernels for wide registers. More, which takes
/// hundreds of agents nearby, are left to the scalar kernel.
constexpr std::size_t max_blocks_seen = 32;

/// A kernel, which adds the candidate pairs of a row of cells.
using AddPairsOfRow = void (*)(HalfBlock&, int, PairBuffer&);

/// Returns the kernel for these instructions, or for the next simpler ones that have a kernel. All add the same pairs
/// in the same order, as a test verifies. Contract: is_available(target).
AddPairsOfRow add_pairs_kernel(Target target);

void add_pairs_of_row_scalar(HalfBlock& half, int row, PairBuffer& buffer);

// Kernels of one file each; nullptr where the file has none for these instructions.

AddPairsOfRow add_pairs_with_avx512(Target target);
AddPairsOfRow add_pairs_with_highway(Target target);

/// Calls PackedGrid::find_candidate_pairs() with one of the kernels.
void find_candidate_pairs(PackedGrid const& grid, double cutoff, AddPairsOfRow add_pairs_of_row,
                          OnPairs const& on_pairs);

/// The five blocks of a cell and its half block, for cells in a row and blocks of 3×3 cells.
struct FiveBlocks {
  PackedGrid::Block const& home;
  PackedGrid::Block const& east;
  PackedGrid::Block const& north_west;
  PackedGrid::Block const& north;
  PackedGrid::Block const& north_east;

  /// Returns whether each of the five cells has only one block.
  [[nodiscard]] bool are_all() const {
    return (home.next & east.next & north_west.next & north.next & north_east.next) == PackedGrid::none;
  }
};

/// The columns or rows of a window, and those beside it.
class PlacesOfWindow {
 public:
  PlacesOfWindow(int first, int end, int all, bool is_periodic)
      : first_(first), count_(end - first), goes_around_(is_periodic && count_ == all) {}

  [[nodiscard]] int count() const { return count_; }
  /// Returns the column or row for block_at(). A place outside the window has the index of an empty cell.
  [[nodiscard]] int at(int place) const {
    if (place >= 0 && place < count_) return first_ + place;
    return first_ + (!goes_around_ ? count_ : place < 0 ? place + count_ : place - count_);
  }
  /// Returns whether the window has such a column or row.
  [[nodiscard]] bool has(int place) const { return goes_around_ || (place >= 0 && place < count_); }

 private:
  int first_;
  int count_;
  bool goes_around_;
};

inline PlacesOfWindow columns_of_window(PackedGrid const& grid) {
  CellWindow const& window = grid.window();
  return {window.first_column, window.end_column, grid.layout().columns(), grid.layout().is_periodic_x()};
}
inline PlacesOfWindow rows_of_window(PackedGrid const& grid) {
  CellWindow const& window = grid.window();
  return {window.first_row, window.end_row, grid.layout().rows(), grid.layout().is_periodic_y()};
}

/// The cells of a row of the window and the blocks that they look at. It copies fields of the grid, because a compiler
/// cannot know that writing pairs does not change them.
class RowOfCells {
 public:
  RowOfCells(PackedGrid const& grid, int row) : RowOfCells(grid, row, columns_of_window(grid)) {}

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] FiveBlocks at(int column) const {
    int const left = column == 0 ? left_of_first_ : column - 1;
    int const right = column + 1 == columns_ ? right_of_last_ : column + 1;
    return {here_[column], here_[right], above_[left], above_[column], above_[right]};
  }

 private:
  RowOfCells(PackedGrid const& grid, int row, PlacesOfWindow const& columns)
      : here_(&grid.block_at(columns.at(0), rows_of_window(grid).at(row))),
        above_(&grid.block_at(columns.at(0), rows_of_window(grid).at(row + 1))),
        columns_(columns.count()),
        left_of_first_(columns.at(-1) - columns.at(0)),
        right_of_last_(columns.at(columns_) - columns.at(0)) {}

  PackedGrid::Block const* here_;
  PackedGrid::Block const* above_;
  int columns_;
  int left_of_first_;
  int right_of_last_;
};

}  // namespace gridlock
