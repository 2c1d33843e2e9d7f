#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

/// The rows of a block of cells, where agents lie in memory in the order of their cells.
struct RowBlock {
  std::array<RowRange, 6> rows{};
  std::size_t count = 0;       ///< of ranges of rows
  std::size_t candidates = 0;  ///< rows in all of them
  bool is_at_edge = true;      ///< whether images matter

  [[nodiscard]] std::span<RowRange const> ranges() const { return std::span(rows).first(count); }
};

/// Collects the blocks around the cells of a layout; `first_of(column, row)` is the first row of a cell, and
/// first_of(column + 1, row) the end of its rows.
template <class FirstOf>
class RowBlocks {
 public:
  RowBlocks(CellLayout const& layout, FirstOf first_of) : layout_(layout), first_of_(first_of) {}

  /// The 3×3 block around a cell, no cell twice.
  [[nodiscard]] RowBlock around(int column, int row) const {
    int const rows = layout_.rows();
    RowBlock block{.is_at_edge = is_at_edge(column, row)};
    if (!layout_.is_periodic()) {
      for (int r = std::max(0, row - 1); r < std::min(rows, row + 2); ++r) add_row(block, column, r);
    } else if (rows <= 3) {
      for (int r = 0; r < rows; ++r) add_row(block, column, r);
    } else {
      for (int const r : {row == 0 ? rows - 1 : row - 1, row, row + 1 == rows ? 0 : row + 1}) add_row(block, column, r);
    }
    return block;
  }

  /// Half of the block: what comes after the cell to the right and in the next row, so that every pair of cells is seen
  /// from one of the two. The first range begins with the cell itself. Contract: has_halves().
  [[nodiscard]] RowBlock after(int column, int row) const {
    int const columns = layout_.columns();
    int const rows = layout_.rows();
    RowBlock block{.is_at_edge = is_at_edge(column, row)};
    bool const is_last = column + 1 == columns;
    add(block, row, column, is_last ? columns : column + 2);
    if (is_last && layout_.is_periodic()) add(block, row, 0, 1);
    if (row + 1 < rows) {
      add_row(block, column, row + 1);
    } else if (layout_.is_periodic()) {
      add_row(block, column, 0);
    }
    return block;
  }

  /// Whether no two cells are neighbours on both sides of a periodic box.
  [[nodiscard]] bool has_halves() const {
    return !layout_.is_periodic() || (layout_.columns() > 3 && layout_.rows() > 3);
  }

 private:
  [[nodiscard]] bool is_at_edge(int column, int row) const {
    int const columns = layout_.columns();
    int const rows = layout_.rows();
    return column == 0 || column + 1 == columns || row == 0 || row + 1 == rows || columns < 4 || rows < 4;
  }

  /// Columns first … end − 1 of a row of cells.
  void add(RowBlock& block, int row, int first, int end) const {
    RowRange const range{first_of_(first, row), first_of_(end, row)};
    block.rows[block.count++] = range;
    block.candidates += range.end - range.first;
  }

  /// The cells of a row next to a column, and that of the column.
  void add_row(RowBlock& block, int column, int row) const {
    int const columns = layout_.columns();
    if (!layout_.is_periodic() || (column > 0 && column + 1 < columns)) {
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
