#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/exact/moving_disk.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock::exact {

/// A grid whose cells hold the indices of their disks in a few fixed slots, so that the candidates of a prediction are
/// three short runs of memory.
///
///     ┌────┬────┬────┬────┐   one row of slots: 3 cells × 4 slots = 48 bytes in a run
///     │ ·· │ 07 │ 3· │ ·· │   dotted: empty. The outermost cells are ghosts: copies of the other side behind
///     └────┴────┴────┴────┘   periodic edges, empty behind a wall; no search has to look where the box ends.
///
/// Cells with a side in [σ, √2 σ) hold at most four centres of hard disks of diameter σ. Where disks are smaller or
/// cells larger, a cell that runs full doubles the slots of all cells.
///
/// A disk may belong to a cell after it has left it, up to a margin beyond the border, so that a disk that soon comes
/// back causes no events.
///
///     ┌╌╌╌╌╌╌╌╌╌╌╌┐      Centres of two disks that touch are no more than `reach` apart. Cells are wider than
///     ╎ ┌───────┐ ╎      that, and the margin is half of the excess: so each disk still belongs to one of the
///     ╎ │ cell  │ ╎      3×3 cells around the other. There is no margin at the edges of the box, where
///     ╎ └───────┘ ╎      coordinates change.
///     └╌╌╌╌╌╌╌╌╌╌╌┘ ◄─ limits
///
/// In an oblique box the ghosts are not those of the images: there only for_each_run() looks across edges.
///
/// Cost: insert, erase O(slots per cell).
class SlotGrid {
 public:
  SlotGrid() = default;
  /// Without `reach` disks belong to the cells in which they are.
  SlotGrid(CellLayout const& layout, Box const& box, double reach = std::numeric_limits<double>::infinity());

  [[nodiscard]] std::int32_t columns() const { return columns_; }
  [[nodiscard]] std::int32_t rows() const { return rows_; }
  /// Limits of the columns to which disks belong: entry 2c is the lower x of column c, 2c + 1 the upper; likewise for
  /// rows.
  [[nodiscard]] double const* column_limits() const { return column_limits_.data(); }
  [[nodiscard]] double const* row_limits() const { return row_limits_.data(); }
  /// Largest distance of a disk from the cell that it belongs to, in x or y.
  [[nodiscard]] double largest_margin() const { return largest_margin_; }
  /// Returns the column of x; the last one for a disk that is beyond the edge of a periodic box by rounding.
  [[nodiscard]] std::int32_t column_of(double x) const { return index_of(x * layout_.columns_per_length(), columns_); }
  [[nodiscard]] std::int32_t row_of(double y) const { return index_of(y * layout_.rows_per_length(), rows_); }

  /// Returns the cell of the image in the box of a position outside it.
  [[nodiscard]] Cell cell_of_image(Vector place) const {
    if (box_.is_oblique()) place = box_.inside(place);
    return {layout_.column_of(place.x), layout_.row_of(place.y)};
  }

  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Number of slots from one row of cells to the next.
  [[nodiscard]] std::size_t row_stride() const { return stride_ * capacity_; }
  [[nodiscard]] Index const* slots() const { return slots_.data(); }
  /// The slots of a cell. Column −1 and column `columns`, row −1 and row `rows` are the ghosts. Behind the last slot
  /// there are more empty slots than a register has lanes, so that wide loads stay in bounds.
  [[nodiscard]] Index const* slots_of(std::int32_t column, std::int32_t row) const {
    return slots_.data() + first_slot_of(column, row);
  }

  /// Calls visit(slots) once for each run of slots of the cells that have a point, or an image of a point, between
  /// `lower` and `upper`. There are no cells beyond walls.
  template <class Visit>
  void for_each_run(Vector lower, Vector upper, Visit visit) const {
    Range columns = range(lower.x, upper.x, layout_.columns_per_length(), columns_, layout_.is_periodic_x());
    Range const rows = range(lower.y, upper.y, layout_.rows_per_length(), rows_, layout_.is_periodic_y());
    bool const has_all_rows = rows.end - rows.first == rows_;
    for (std::int32_t row = rows.first; row < rows.end; ++row) {
      if (box_.is_oblique()) columns = has_all_rows ? Range{0, columns_} : columns_in_oblique(row, lower.x, upper.x);
      std::int32_t const inside_row = wrapped(row, rows_);
      for (std::int32_t column = columns.first; column < columns.end;) {
        std::int32_t const inside_column = wrapped(column, columns_);
        std::int32_t const count = std::min(columns.end - column, columns_ - inside_column);
        visit(std::span(slots_of(inside_column, inside_row), static_cast<std::size_t>(count) * capacity_));
        column += count;
      }
    }
  }

  [[nodiscard]] bool is_full(std::int32_t column, std::int32_t row) const {
    return *(slots_of(column, row) + capacity_ - 1) != no_disk;
  }
  void insert(Index disk, std::int32_t column, std::int32_t row);
  void erase(Index disk, std::int32_t column, std::int32_t row);
  /// Changes the index of every disk i to new_number[i].
  void rename(std::vector<Index> const& new_number);

 private:
  [[nodiscard]] std::size_t first_slot_of(std::int32_t column, std::int32_t row) const {
    return (static_cast<std::size_t>(row + 1) * stride_ + static_cast<std::size_t>(column + 1)) * capacity_;
  }
  struct Range {
    std::int32_t first;
    std::int32_t end;
  };
  static Range range(double lower, double upper, double cells_per_length, std::int32_t count, bool is_periodic) {
    auto const most = static_cast<double>(count);
    auto const first = static_cast<std::int32_t>(std::clamp(std::floor(lower * cells_per_length), -most, 2.0 * most));
    auto const last = static_cast<std::int32_t>(std::clamp(std::floor(upper * cells_per_length), -most, 2.0 * most));
    if (!is_periodic) return {std::clamp(first, 0, count - 1), std::clamp(last, 0, count - 1) + 1};
    if (last - first >= count - 1) return {0, count};
    return {first, last + 1};
  }
  [[nodiscard]] Range columns_in_oblique(std::int32_t row, double lower, double upper) const;
  static std::int32_t wrapped(std::int32_t index, std::int32_t count) {
    if (index < 0) return index + count;
    return index >= count ? index % count : index;
  }
  static std::int32_t index_of(double index, std::int32_t count) {
    return static_cast<std::int32_t>(std::clamp(index, 0.0, static_cast<double>(count - 1)));
  }
  [[nodiscard]] bool is_at_edge(std::int32_t column, std::int32_t row) const {
    return column == 0 || row == 0 || column == columns_ - 1 || row == rows_ - 1;
  }
  void copy_to_ghosts(std::int32_t column, std::int32_t row);
  void double_capacity();

  CellLayout layout_;
  Box box_;
  bool has_images_ = false;
  std::int32_t columns_ = 0;
  std::int32_t rows_ = 0;
  std::size_t stride_ = 0;
  std::size_t capacity_ = 4;
  LargeArray<Index> slots_;
  double largest_margin_ = 0.0;
  std::vector<double> column_limits_;
  std::vector<double> row_limits_;
};

}  // namespace gridlock::exact
