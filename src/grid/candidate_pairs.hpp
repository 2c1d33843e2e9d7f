#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {

/// Pairs found but not yet handed out. Whether a candidate is a pair is as good as random, so asking would stall the
/// processor at every other pair; instead every candidate is written and only the count depends on the answer.
class PairBuffer {
 public:
  using Pair = AgentPair;
  /// Pairs that may be written behind the last one that counts.
  static constexpr std::size_t slack = 16;
  /// The most that are kept before they are handed out.
  static constexpr std::size_t capacity = 1024;

  explicit PairBuffer(OnPairs const& on_pairs) : on_pairs_(on_pairs) {}

  /// Where the next pairs are written, at most `pairs` of which count.
  Pair* room_for(std::size_t pairs) {
    if (size_ + pairs > capacity) flush();
    return pairs_.data() + size_;
  }
  /// All that was written before `end` counts.
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

/// A block that the agents of a cell look at, and what is added to their places to see them from there.
struct SeenBlock {
  PackedGrid::Block const* block;
  float shift_x;
  float shift_y;
};

/// The half of a block of cells, to the right and above, that meets every pair once.
struct HalfBlock {
  PackedGrid const& grid;
  int reach_columns;
  int reach_rows;
  float limit;                       ///< PackedGrid::local_limit()
  std::vector<SeenBlock> seen = {};  ///< room for blocks_seen_from()
};

// Columns and rows count from 0 in the window of the grid.

/// The blocks of a cell, then those of the cells of its half block, in the order in which each of its agents looks at
/// them: at its own block first, at the later slots of it only, and not at the blocks before.
std::span<SeenBlock const> blocks_seen_from(HalfBlock& half, int column, int row);

/// The candidates of one cell.
void add_pairs_of_cell_scalar(HalfBlock& half, int column, int row, PairBuffer& buffer);

/// The most blocks beside its own an agent looks at in kernels for wide registers; more, which takes hundreds of agents
/// nearby, are for the scalar version.
constexpr std::size_t max_blocks_seen = 32;

/// A kernel: the candidates of a row of cells.
using AddPairsOfRow = void (*)(HalfBlock&, int, PairBuffer&);

/// The kernel for these instructions, or for the next plainer ones that have one. All add the same pairs in the same
/// order, which a test compares. Contract: is_available(target).
AddPairsOfRow add_pairs_kernel(Target target);

void add_pairs_of_row_scalar(HalfBlock& half, int row, PairBuffer& buffer);

// The kernels of one file each; nullptr where it has none for these instructions.

AddPairsOfRow add_pairs_with_avx512(Target target);
AddPairsOfRow add_pairs_with_highway(Target target);

/// PackedGrid::find_candidate_pairs() by one of the kernels.
void find_candidate_pairs(PackedGrid const& grid, double cutoff, AddPairsOfRow add_pairs_of_row,
                          OnPairs const& on_pairs);

/// The five blocks of a cell in a row whose half block is that of 3×3 cells.
struct FiveBlocks {
  PackedGrid::Block const& home;
  PackedGrid::Block const& east;
  PackedGrid::Block const& north_west;
  PackedGrid::Block const& north;
  PackedGrid::Block const& north_east;

  /// Whether each of the five cells has one block only.
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
  /// The column or row that block_at() takes; that of an empty cell for a place which is none.
  [[nodiscard]] int at(int place) const {
    if (place >= 0 && place < count_) return first_ + place;
    return first_ + (!goes_around_ ? count_ : place < 0 ? place + count_ : place - count_);
  }
  /// Whether there is such a place.
  [[nodiscard]] bool has(int place) const { return goes_around_ || (place >= 0 && place < count_); }

 private:
  int first_;
  int count_;
  bool goes_around_;
};

inline PlacesOfWindow columns_of_window(PackedGrid const& grid) {
  CellWindow const& window = grid.window();
  return {window.first_column, window.end_column, grid.layout().columns(), grid.layout().is_periodic()};
}
inline PlacesOfWindow rows_of_window(PackedGrid const& grid) {
  CellWindow const& window = grid.window();
  return {window.first_row, window.end_row, grid.layout().rows(), grid.layout().is_periodic()};
}

/// The cells of a row of the window and what they look at. Copies what it needs of the grid: the compiler cannot know
/// that the pairs written in between change none of it.
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
