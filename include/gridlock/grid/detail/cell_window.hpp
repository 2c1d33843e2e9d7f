#pragma once

#include <algorithm>
#include <cstddef>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// A rectangle of cells. Along a periodic axis it may begin below 0 or end beyond the last column or row.
struct CellWindow {
  int first_column = 0, end_column = 0;
  int first_row = 0, end_row = 0;

  friend bool operator==(CellWindow const&, CellWindow const&) = default;
};

/// Returns the part of a window inside walls. Along a periodic axis a window that is wider than the box becomes the
/// whole box.
inline CellWindow within(CellLayout const& layout, CellWindow window) {
  auto const cut = [&](int& begin, int& end, int all, bool is_periodic) {
    if (!is_periodic) {
      begin = std::max(0, begin);
      end = std::min(all, end);
    } else if (end - begin >= all) {
      begin = 0;
      end = all;
    }
  };
  cut(window.first_column, window.end_column, layout.columns(), layout.is_periodic_x());
  cut(window.first_row, window.end_row, layout.rows(), layout.is_periodic_y());
  return window;
}

/// Numbers the cells of a window 0, 1, 2 … in the order of the cells in the whole box.
///
///     a window that goes around     ┌──────────┐      columns of the box  0 1 │ 2 … 7 │ 8 9
///     the box, of columns 8 … 11    │01      23│      of the window       0 1 │       │ 2 3
class CellNumbers {
 public:
  CellNumbers() = default;
  explicit CellNumbers(CellLayout const& layout)
      : CellNumbers(layout, {.end_column = layout.columns(), .end_row = layout.rows()}) {}
  CellNumbers(CellLayout const& layout, CellWindow const& whole_window) {
    CellWindow const window = within(layout, whole_window);
    columns_ = side(window.first_column, window.end_column, layout.columns());
    rows_ = side(window.first_row, window.end_row, layout.rows());
    is_whole_ = columns() == layout.columns() && rows() == layout.rows();
  }

  [[nodiscard]] int columns() const { return columns_.count(); }
  [[nodiscard]] int rows() const { return rows_.count(); }
  [[nodiscard]] std::size_t count() const {
    return static_cast<std::size_t>(columns()) * static_cast<std::size_t>(rows());
  }
  /// Returns the number of a cell of the window; for a cell beside the window in one of its rows, the number of cells
  /// before.
  [[nodiscard]] std::size_t number_of(int column, int row) const {
    if (!is_whole_) [[unlikely]]
      return number_in_window(column, row);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_.end) + static_cast<std::size_t>(column);
  }
  /// Return the column or row of the box that is number `place` in the window.
  [[nodiscard]] int column_at(int place) const { return columns_.at(place); }
  [[nodiscard]] int row_at(int place) const { return rows_.at(place); }

 private:
  [[nodiscard]] std::size_t number_in_window(int column, int row) const {
    return static_cast<std::size_t>(rows_.place_of(row)) * static_cast<std::size_t>(columns()) +
           static_cast<std::size_t>(columns_.place_of(column));
  }

  /// The columns or rows of a window: 0 … head − 1 and first … end − 1 of the box.
  struct Side {
    int head = 0, first = 0, end = 0;

    [[nodiscard]] int count() const { return head + end - first; }
    [[nodiscard]] int place_of(int k) const { return k < first ? std::min(k, head) : head + std::min(k, end) - first; }
    [[nodiscard]] int at(int place) const { return place < head ? place : place - head + first; }
  };
  static Side side(int begin, int end, int all) {
    if (end <= begin) return {};
    if (begin < 0) return {.head = end, .first = begin + all, .end = all};
    if (end > all) return {.head = end - all, .first = begin, .end = all};
    return {.head = 0, .first = begin, .end = end};
  }

  Side columns_;
  Side rows_;
  bool is_whole_ = false;
};

}  // namespace gridlock
