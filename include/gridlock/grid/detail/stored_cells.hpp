#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of a rectangle that are stored, and the index of each among them: all cells, or only occupied cells, so
/// that there may be far more cells than agents. Cells have the numbers row · columns + column.
///
///     cells     0 1 2 3 4 5 6 7        bits  0 1 0 0 1 1 0 0
///     occupied    1     4 5            places  0     1 2      place_of(2) = place_of(3) = place_of(4) = 1
///
/// Memory: none if all cells are stored, else 16 bytes for 64 cells.
class StoredCells {
 public:
  enum class Which { all, occupied };

  /// Starts anew with all cells 0 … cells − 1; or with none: then call add() or add_alone() for each occupied cell, and
  /// find_places() at the end.
  void clear(std::size_t cells, Which which) {
    count_ = which == Which::all ? cells : 0;
    words_.assign(which == Which::all ? 0 : cells / 64 + 1, {});
  }
  /// Adds a cell. Several threads may add cells at the same time.
  void add(std::size_t cell) {
    std::atomic_ref<std::uint64_t> const bits(words_[cell / 64].bits);
    std::uint64_t const bit = std::uint64_t{1} << cell % 64;
    // Most cells have been added already, and a read is cheaper than an atomic write.
    if ((bits.load(std::memory_order_relaxed) & bit) == 0) bits.fetch_or(bit, std::memory_order_relaxed);
  }
  /// Adds a cell. Contract: no other thread adds cells at the same time.
  void add_alone(std::size_t cell) { words_[cell / 64].bits |= std::uint64_t{1} << cell % 64; }
  void find_places() {
    count_ = 0;
    for (Word& word : words_) {
      word.before = count_;
      count_ += count_bits(word.bits);
    }
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  /// Returns the number of stored cells before `cell`, which is its own index if it is stored. `cell` may be one behind
  /// the last.
  [[nodiscard]] std::size_t place_of(std::size_t cell) const {
    if (words_.empty()) return cell;
    Word const& word = words_[cell / 64];
    std::uint64_t const before = (std::uint64_t{1} << cell % 64) - 1;
    return word.before + count_bits(word.bits & before);
  }

  /// Calls visit(column, row, place) for every stored cell in rows first … end − 1 of cells, in order; `place` is its
  /// index.
  template <class Visit>
  void for_each_in_rows(int columns, int first, int end, Visit visit) const {
    std::size_t cell = static_cast<std::size_t>(first) * static_cast<std::size_t>(columns);
    std::size_t place = place_of(cell);
    for (int row = first; row < end; ++row) {
      if (words_.empty()) {
        for (int column = 0; column < columns; ++column) visit(column, row, place++);
        continue;
      }
      std::size_t const row_end = cell + static_cast<std::size_t>(columns);
      for (std::size_t base = cell; base < row_end; base = (base / 64 + 1) * 64) {
        for (std::uint64_t left = words_[base / 64].bits >> base % 64; left != 0; left &= left - 1) {
          std::size_t const found = base + static_cast<std::size_t>(std::countr_zero(left));
          if (found >= row_end) break;
          visit(static_cast<int>(found - cell), row, place++);
        }
      }
      cell = row_end;
    }
  }

 private:
  struct Word {
    std::uint64_t bits = 0;
    std::size_t before = 0;
  };

  /// Counts set bits. Written out, since std::popcount would call a function on processors without an instruction for
  /// it.
  static std::size_t count_bits(std::uint64_t bits) {
    bits -= bits >> 1 & 0x5555555555555555U;
    bits = (bits & 0x3333333333333333U) + (bits >> 2 & 0x3333333333333333U);
    bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fU;
    return bits * 0x0101010101010101U >> 56;
  }

  std::vector<Word> words_;  ///< bit k of word n is set if cell 64 n + k is stored; with a bit for the end
  std::size_t count_ = 0;
};

/// Returns cells as small as the cutoff, for agents that crowd in a part of the box; only the occupied cells are to be
/// stored, in 16 bytes for each agent at most. Returns nothing if the cells of `layout` are nearly as small.
inline std::optional<CellLayout> layout_for_crowd(Box const& box, double cutoff, std::size_t agents,
                                                  CellLayout const& layout) {
  CellLayout const finer = layout_for_cutoff(box, cutoff, agents, 64.0);
  return finer.count() / 2 > layout.count() ? std::optional(finer) : std::nullopt;
}

/// Returns whether agents crowd: on average an agent shares its cell with more than four others. Agents that are spread
/// uniformly share a cell with at most two others if cells are coarser than the cutoff.
inline bool is_crowd(std::uint64_t pairs_in_cells, std::size_t agents) { return pairs_in_cells > 2 * agents; }

}  // namespace gridlock
