#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "gridlock/core/box.hpp"

namespace gridlock {

/// The division of a box into columns × rows equal cells, which the paper calls neighbourhoods.
///
///     rows−1 │ … │   │   │        cell = row · columns + column
///          1 │ k │   │   │        a periodic box continues on the other side,
///          0 │ 0 │ 1 │ 2 │        and ends at walls, for x and y apart
///              0   1   2  columns−1
///
/// A point outside a periodic box is in the cell of its image inside, a point outside walls in the nearest cell.
///
/// Errors: Error for no columns or rows, or for more than 2³¹ cells.
///
/// ```cpp
/// CellLayout const layout = layout_for_cutoff(Box(10.0, 10.0, Edge::periodic), 1.0, 500);
/// int const cell = layout.cell_of({0.5, 9.5});
/// layout.for_each_cell_in_block(cell, 1, 1, [](int neighbour) { /* nine cells */ });
/// ```
class CellLayout {
 public:
  CellLayout() = default;
  CellLayout(Box const& box, std::uint64_t columns, std::uint64_t rows);

  [[nodiscard]] constexpr int columns() const { return columns_; }
  [[nodiscard]] constexpr int rows() const { return rows_; }
  [[nodiscard]] constexpr int count() const { return columns_ * rows_; }
  [[nodiscard]] constexpr double cell_width() const { return cell_width_; }
  [[nodiscard]] constexpr double cell_height() const { return cell_height_; }
  [[nodiscard]] constexpr double columns_per_length() const { return columns_per_length_; }
  [[nodiscard]] constexpr double rows_per_length() const { return rows_per_length_; }
  [[nodiscard]] constexpr bool is_periodic_x() const { return is_periodic_x_; }
  [[nodiscard]] constexpr bool is_periodic_y() const { return is_periodic_y_; }

  [[nodiscard]] constexpr int column_of(double x) const {
    return index_of(x, columns_per_length_, columns_, width_, is_periodic_x_);
  }
  [[nodiscard]] constexpr int row_of(double y) const {
    return index_of(y, rows_per_length_, rows_, height_, is_periodic_y_);
  }
  [[nodiscard]] constexpr int cell_of(Vector p) const { return row_of(p.y) * columns_ + column_of(p.x); }

  /// Returns the image of a point that lies in the box; in a box with walls the point itself.
  [[nodiscard]] constexpr Vector image_in_cell(Vector p) const {
    return {image_in_cells(p.x, columns_per_length_, columns_, width_, is_periodic_x_),
            image_in_cells(p.y, rows_per_length_, rows_, height_, is_periodic_y_)};
  }

  /// Calls visit(cell) once for every cell within `reach_columns` and `reach_rows` of `cell`, itself included: the 3×3
  /// block for 1, 1. There are no cells outside walls; a periodic block wider than the box visits no cell twice.
  template <class Visit>
  constexpr void for_each_cell_in_block(int cell, int reach_columns, int reach_rows, Visit visit) const {
    int const row = cell / columns_;
    Range const x = range(cell - row * columns_, reach_columns, columns_, is_periodic_x_);
    Range const y = range(row, reach_rows, rows_, is_periodic_y_);
    for (int r = y.first; r < y.end; ++r) {
      int const row_start = wrapped(r, rows_) * columns_;
      for (int c = x.first; c < x.end; ++c) visit(row_start + wrapped(c, columns_));
    }
  }

  /// Returns whether a point is in the 3×3 block around a cell.
  [[nodiscard]] constexpr bool is_in_block(int cell, Vector p) const {
    int const row = cell / columns_;
    return are_next(cell - row * columns_, column_of(p.x), columns_, is_periodic_x_) &&
           are_next(row, row_of(p.y), rows_, is_periodic_y_);
  }

  /// A cell of a block, and its distance from the middle cell in columns and rows across periodic edges.
  struct CellSeen {
    int column, row;
    int to_the_right, up;
  };
  /// Calls visit(CellSeen) for the cells of for_each_cell_in_block(), in the same order.
  /// Contract: the block does not go around the box, see goes_around().
  template <class Visit>
  constexpr void for_each_cell_seen_from(int column, int row, int reach_columns, int reach_rows, Visit visit) const {
    Range const x = range(column, reach_columns, columns_, is_periodic_x_);
    Range const y = range(row, reach_rows, rows_, is_periodic_y_);
    for (int r = y.first; r < y.end; ++r) {
      int const seen_row = wrapped(r, rows_);
      for (int c = x.first; c < x.end; ++c) visit(CellSeen{wrapped(c, columns_), seen_row, c - column, r - row});
    }
  }
  /// Returns whether a block contains every column or every row along a periodic axis: a cell may then be seen on two
  /// sides.
  [[nodiscard]] constexpr bool goes_around(int reach_columns, int reach_rows) const {
    return (is_periodic_x_ && has_all(reach_columns, columns_)) || (is_periodic_y_ && has_all(reach_rows, rows_));
  }

  /// Return the smallest number of columns or rows to each side that contain every point nearer than `distance` to a
  /// cell.
  [[nodiscard]] constexpr int columns_within(double distance) const {
    return cells_within(distance, columns_per_length_, columns_);
  }
  [[nodiscard]] constexpr int rows_within(double distance) const {
    return cells_within(distance, rows_per_length_, rows_);
  }

  friend bool operator==(CellLayout const&, CellLayout const&) = default;

 private:
  struct Range {
    int first;
    int end;
  };

  /// Returns whether a coordinate counted in cells lies in the box. Cells and images use the same test, so that they
  /// agree for a coordinate within rounding of an edge.
  static constexpr bool is_in_cells(double index, int count) { return (index >= 0.0) & (index < count); }
  static constexpr int index_of(double p, double per_length, int count, double side, bool is_periodic) {
    double const index = p * per_length;
    return is_in_cells(index, count) ? static_cast<int>(index)
                                     : index_from_outside(p, per_length, count, side, is_periodic);
  }
  [[gnu::cold]] static constexpr int index_from_outside(double p, double per_length, int count, double side,
                                                        bool is_periodic) {
    double const index = (is_periodic ? image_inside(p, side) : p) * per_length;
    // Clamped before the conversion, which is undefined for a point far outside walls; max(0, NaN) is 0.
    return static_cast<int>(std::min(std::max(0.0, index), static_cast<double>(count - 1)));
  }
  static constexpr double image_in_cells(double p, double per_length, int count, double side, bool is_periodic) {
    return !is_periodic || is_in_cells(p * per_length, count) ? p : image_inside(p, side);
  }
  static constexpr int cells_within(double distance, double per_length, int count) {
    // The margins cover rounding of the distance, relative to the distance, and of points, relative to the side.
    double const cells = distance * per_length * (1.0 + 1e-12) + 1e-15 * count;
    if (!(cells < count)) return count;
    int const whole = static_cast<int>(cells);
    return whole < cells ? whole + 1 : whole;
  }
  static constexpr bool are_next(int one, int other, int count, bool is_periodic) {
    int const apart = one < other ? other - one : one - other;
    return apart <= 1 || (is_periodic && apart == count - 1);
  }
  static constexpr Range range(int index, int cutoff, int count, bool is_periodic) {
    if (!is_periodic) return {std::max(0, index - cutoff), std::min(count, index + cutoff + 1)};
    return has_all(cutoff, count) ? Range{0, count} : Range{index - cutoff, index + cutoff + 1};
  }
  static constexpr bool has_all(int cutoff, int count) { return cutoff >= count - 1 - cutoff; }
  static constexpr int wrapped(int index, int count) {
    if (index < 0) return index + count;
    return index >= count ? index - count : index;
  }

  int columns_ = 1;
  int rows_ = 1;
  double width_ = 1.0;
  double height_ = 1.0;
  double cell_width_ = 1.0;
  double cell_height_ = 1.0;
  double columns_per_length_ = 1.0;
  double rows_per_length_ = 1.0;
  bool is_periodic_x_ = false;
  bool is_periodic_y_ = false;
};

/// Returns the layout with the smallest cells whose 3×3 block contains every point nearer than `cutoff`, with at most
/// about `cells_per_agent` cells for each agent. Errors: Error for a cutoff that is negative or NaN.
CellLayout layout_for_cutoff(Box const& box, double cutoff, std::size_t agents, double cells_per_agent = 2.0);

}  // namespace gridlock
