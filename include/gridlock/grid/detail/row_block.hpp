#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

/// The rows of agents in a block of cells, for agents sorted by their cells.
struct RowBlock {
  std::array<RowRange, 6> rows{};
  std::size_t count = 0;       ///< number of ranges in `rows`
  std::size_t candidates = 0;  ///< number of rows in all ranges
  bool is_at_edge = true;      ///< whether distances may cross a periodic edge

  [[nodiscard]] constexpr std::span<RowRange const> ranges() const { return std::span(rows).first(count); }
};

/// Returns whether no two cells are neighbours on two sides of a periodic box.
constexpr bool has_halves(CellLayout const& layout) {
  return (!layout.is_periodic_x() || layout.columns() > 3) && (!layout.is_periodic_y() || layout.rows() > 3);
}

/// Makes the blocks around the cells of a layout; first_of(column, row) returns the first row of a cell, and
/// first_of(column + 1, row) the end of its rows.
template <class FirstOf>
class RowBlocks {
 public:
  constexpr RowBlocks(CellLayout const& layout, FirstOf first_of) : layout_(layout), first_of_(first_of) {}

  /// Returns the 3×3 block around a cell, with no cell twice.
  [[nodiscard]] constexpr RowBlock around(int column, int row) const {
    int const rows = layout_.rows();
    RowBlock block{.is_at_edge = is_at_edge(column, row)};
    if (!layout_.is_periodic_y()) {
      for (int r = std::max(0, row - 1); r < std::min(rows, row + 2); ++r) add_row(block, column, r);
    } else if (rows <= 3) {
      for (int r = 0; r < rows; ++r) add_row(block, column, r);
    } else {
      for (int const r : {row == 0 ? rows - 1 : row - 1, row, row + 1 == rows ? 0 : row + 1}) add_row(block, column, r);
    }
    return block;
  }

  /// Returns half of the block: the cell itself first, the cell to the right and those in the next row. Every pair of
  /// cells is in the half block of exactly one of the two cells. Contract: has_halves().
  [[nodiscard]] constexpr RowBlock after(int column, int row) const {
    int const columns = layout_.columns();
    int const rows = layout_.rows();
    RowBlock block{.is_at_edge = is_at_edge(column, row)};
    bool const is_last = column + 1 == columns;
    add(block, row, column, is_last ? columns : column + 2);
    if (is_last && layout_.is_periodic_x()) add(block, row, 0, 1);
    if (row + 1 < rows) {
      add_row(block, column, row + 1);
    } else if (layout_.is_periodic_y()) {
      add_row(block, column, 0);
    }
    return block;
  }

  [[nodiscard]] constexpr bool has_halves() const { return gridlock::has_halves(layout_); }

 private:
  [[nodiscard]] constexpr bool is_at_edge(int column, int row) const {
    int const columns = layout_.columns();
    int const rows = layout_.rows();
    return column == 0 || column + 1 == columns || row == 0 || row + 1 == rows || columns < 4 || rows < 4;
  }

  /// Adds columns first … end − 1 of a row of cells.
  constexpr void add(RowBlock& block, int row, int first, int end) const {
    RowRange const range{first_of_(first, row), first_of_(end, row)};
    block.rows[block.count++] = range;
    block.candidates += range.end - range.first;
  }

  /// Adds the cells of a row in a column and the two next to it.
  constexpr void add_row(RowBlock& block, int column, int row) const {
    int const columns = layout_.columns();
    if (!layout_.is_periodic_x() || (column > 0 && column + 1 < columns)) {
      add(block, row, std::max(0, column - 1), std::min(columns, column + 2));
    } else if (columns <= 3) {
      add(block, row, 0, columns);
    } else {
      bool const is_first = column == 0;
      add(block, row, is_first ? columns - 1 : 0, is_first ? columns : 1);
      add(block, row, is_first ? 0 : columns - 2, is_first ? 2 : columns);
    }
  }

  CellLayout const& layout_;
  FirstOf first_of_;
};

}  // namespace gridlock
