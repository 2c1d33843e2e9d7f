#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "gridlock/core/box.hpp"

namespace gridlock {

/// How a box is cut into columns × rows equal cells, the paper's neighbourhoods.
///
///     rows−1 │ … │   │   │        cell = row · columns + column
///          1 │ k │   │   │        a periodic box continues on the other side,
///          0 │ 0 │ 1 │ 2 │        a walled box ends
///              0   1   2  columns−1
///
/// Errors: no column or row, or more than 2³¹ cells, throws Error.
class CellLayout {
 public:
  CellLayout() = default;
  CellLayout(Box const& box, std::uint64_t columns, std::uint64_t rows);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int count() const { return columns_ * rows_; }
  [[nodiscard]] double cell_width() const { return cell_width_; }
  [[nodiscard]] double cell_height() const { return cell_height_; }
  [[nodiscard]] double columns_per_length() const { return columns_per_length_; }
  [[nodiscard]] double rows_per_length() const { return rows_per_length_; }
  [[nodiscard]] bool is_periodic() const { return is_periodic_; }

  [[nodiscard]] int column_of(double x) const { return index_of(x, columns_per_length_, columns_); }
  [[nodiscard]] int row_of(double y) const { return index_of(y, rows_per_length_, rows_); }
  [[nodiscard]] int cell_of(Vector p) const { return row_of(p.y) * columns_ + column_of(p.x); }

  /// Calls visit(cell) once for every cell within `reach_columns` and `reach_rows` of `cell`, itself included: the 3×3
  /// block for 1, 1. Cells outside the walls do not exist; a periodic block wider than the box names no cell twice.
  template <class Visit>
  void for_each_cell_in_block(int cell, int reach_columns, int reach_rows, Visit visit) const {
    int const row = cell / columns_;
    Range const x = range(cell - row * columns_, reach_columns, columns_);
    Range const y = range(row, reach_rows, rows_);
    for (int r = y.first; r < y.end; ++r) {
      int const row_start = wrapped(r, rows_) * columns_;
      for (int c = x.first; c < x.end; ++c) visit(row_start + wrapped(c, columns_));
    }
  }

  /// The smallest number of cells to each side that holds every point nearer than `distance` to any point of a cell.
  [[nodiscard]] int columns_within(double distance) const {
    return cells_within(distance, columns_per_length_, columns_);
  }
  [[nodiscard]] int rows_within(double distance) const { return cells_within(distance, rows_per_length_, rows_); }

  friend bool operator==(CellLayout const&, CellLayout const&) = default;

 private:
  struct Range {
    int first;
    int end;
  };

  static int index_of(double p, double per_length, int count) {
    // Clamped before the conversion, which is undefined for a point far outside; max(0, NaN) is 0.
    return static_cast<int>(std::min(std::max(0.0, p * per_length), static_cast<double>(count - 1)));
  }
  static int cells_within(double distance, double per_length, int count) {
    // The margins cover rounding: of the distance, relative to it, and of points and index_of(), relative to the side.
    double const cells = distance * per_length * (1.0 + 1e-12) + 1e-15 * count;
    if (!(cells < count)) return count;
    int const whole = static_cast<int>(cells);
    return whole < cells ? whole + 1 : whole;
  }
  [[nodiscard]] Range range(int index, int reach, int count) const {
    if (!is_periodic_) return {std::max(0, index - reach), std::min(count, index + reach + 1)};
    return 2 * reach + 1 >= count ? Range{0, count} : Range{index - reach, index + reach + 1};
  }
  static int wrapped(int index, int count) {
    if (index < 0) return index + count;
    return index >= count ? index - count : index;
  }

  int columns_ = 1;
  int rows_ = 1;
  double cell_width_ = 1.0;
  double cell_height_ = 1.0;
  double columns_per_length_ = 1.0;
  double rows_per_length_ = 1.0;
  bool is_periodic_ = false;
};

/// The finest layout whose 3×3 block holds every point nearer than `reach`, with at most about two cells an agent.
CellLayout layout_for_reach(Box const& box, double reach, std::size_t agents);

}  // namespace gridlock
