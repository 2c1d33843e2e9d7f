#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"

namespace gridlock {

/// The agents of a cell of a PackedGrid, up to four, and their positions in it; a cache line.
struct alignas(64) PackedBlock {
  static constexpr std::size_t slots = 4;

  std::array<float, slots> x;  ///< position in the cell; `nowhere` in an empty slot
  std::array<float, slots> y;
  std::array<std::uint32_t, slots> agent;
  std::uint32_t next;   ///< the next block of this cell, or none
  std::uint16_t count;  ///< number of agents, which are in the first slots
  /// Flags for the caller. Bit s moves with the agent in slot s, and is cleared when an agent enters. The grid sets
  /// `changed` in the first block of a cell whenever an agent enters or leaves the cell, and no other bits.
  std::uint16_t marks;
  std::int32_t column;
  std::int32_t row;
};
static_assert(sizeof(PackedBlock) == 64);

/// The places of the cells of a PackedGrid in memory and in the plane. Its functions are constexpr, so that a compiler
/// for graphics processors can use them.
class PackedGeometry {
 public:
  using Block = PackedBlock;
  static constexpr std::size_t slots = Block::slots;
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint16_t changed = 0x8000;  ///< a bit of Block::marks

  /// A position relative to the lower left corner of a cell, in units of the longer side of a cell.
  struct LocalPoint {
    float x;
    float y;
  };

  PackedGeometry() = default;
  /// Contract: the window lies inside walls.
  PackedGeometry(CellLayout const& layout, CellWindow const& window);

  [[nodiscard]] constexpr CellLayout const& layout() const { return layout_; }
  [[nodiscard]] CellWindow const& window() const { return window_; }
  /// Returns the number of first blocks: one for each cell and each empty cell around them.
  [[nodiscard]] std::size_t blocks_of_cells() const { return blocks_of_cells_; }

  [[nodiscard]] bool stores(int column, int row) const {
    return stored(column, window_.first_column, window_.end_column, layout_.columns()) <
               window_.end_column - window_.first_column &&
           stored(row, window_.first_row, window_.end_row, layout_.rows()) < window_.end_row - window_.first_row;
  }
  /// Returns the index of the first block of a cell. Contract: the cell is in the window, or an empty cell beside it.
  [[nodiscard]] constexpr std::size_t index_at(int column, int row) const {
    return static_cast<std::size_t>(row * static_cast<std::ptrdiff_t>(stride_) + column - first_);
  }
  /// Returns the index of the first block of a cell; that of an empty block for a cell outside the window.
  [[nodiscard]] constexpr std::size_t index_of(int column, int row) const {
    int const c = stored(column, window_.first_column, window_.end_column, layout_.columns());
    int const r = stored(row, window_.first_row, window_.end_row, layout_.rows());
    return static_cast<std::size_t>(r + 1) * stride_ + static_cast<std::size_t>(c + 1);
  }
  [[nodiscard]] constexpr std::size_t index_of(int cell) const {
    int const row = cell / layout_.columns();
    return index_of(cell - row * layout_.columns(), row);
  }
  /// Returns the number of blocks from a cell to the cell above it. Neighbours are this far and one block away, except
  /// across periodic edges.
  [[nodiscard]] std::ptrdiff_t blocks_in_row() const { return static_cast<std::ptrdiff_t>(stride_); }
  /// Return the next column or row for index_at(): that of an empty cell beyond a wall, and an index beyond the box if
  /// the window continues there across a periodic edge.
  [[nodiscard]] constexpr int column_left_of(int column) const { return column == 0 ? left_of_first_ : column - 1; }
  [[nodiscard]] constexpr int column_right_of(int column) const {
    return column + 1 == layout_.columns() ? right_of_last_ : column + 1;
  }
  [[nodiscard]] constexpr int row_below(int row) const { return row == 0 ? below_first_ : row - 1; }
  [[nodiscard]] constexpr int row_above(int row) const { return row + 1 == layout_.rows() ? above_last_ : row + 1; }

  [[nodiscard]] double locals_per_length() const { return locals_per_length_; }
  /// Return the width and the height of a cell in units of its longer side.
  [[nodiscard]] constexpr float local_width() const { return local_width_; }
  [[nodiscard]] constexpr float local_height() const { return local_height_; }

  /// Returns the position of a point relative to a cell less than a few cells away.
  [[nodiscard]] constexpr LocalPoint local(Vector p, int column, int row) const {
    return {static_cast<float>(p.x * layout_.columns_per_length() - column) * local_width_,
            static_cast<float>(p.y * layout_.rows_per_length() - row) * local_height_};
  }
  /// Returns whether a point is in a cell, and then its position there. Differences in [0, 1) are exact, so that this
  /// is the cell of column_of() and row_of().
  [[nodiscard]] constexpr bool is_in(int column, int row, Vector p, LocalPoint& inside) const {
    double const x = p.x * layout_.columns_per_length() - column;
    double const y = p.y * layout_.rows_per_length() - row;
    inside = {static_cast<float>(x) * local_width_, static_cast<float>(y) * local_height_};
    return (x >= 0.0) & (x < 1.0) & (y >= 0.0) & (y < 1.0);
  }
  /// Returns a position in a cell that is stored for this one: at most farthest_outside beyond the cell.
  [[nodiscard]] static constexpr LocalPoint near_cell(LocalPoint p) { return {near_cell(p.x), near_cell(p.y)}; }

  /// Returns an upper bound, despite rounding, on the squared local distance of pairs nearer than √squared_cutoff in
  /// cells up to `cells` apart.
  [[nodiscard]] float local_limit(double squared_cutoff, int cells = 1) const {
    // Local coordinates have errors of about 1e-7 of the distance in cells: (a + b)² ≤ 1.001 a² + 1001 b².
    double const error = 1e-6 * (cells + 1.0);
    double const limit = 1.001 * squared_cutoff * locals_per_length_ * locals_per_length_ + 1001.0 * error * error;
    return static_cast<float>(std::min(farthest_limit, limit));
  }

  /// A point (in a periodic box its image inside) with its cell.
  struct CellPoint {
    Vector p;
    int column;
    int row;
  };
  [[nodiscard]] constexpr CellPoint cell_point_of(Vector p) const {
    p = layout_.image_in_cell(p);
    return {p, layout_.column_of(p.x), layout_.row_of(p.y)};
  }

  /// A coordinate far from every agent whose square is still finite.
  static constexpr float nowhere = 1e18F;

 private:
  /// A bound above every squared distance between two cells and below the squared distance to `nowhere`.
  static constexpr double farthest_limit = 1e30;
  /// A point farther than this outside its cell, which must be outside walls, is stored at this distance: that makes no
  /// other agent seem farther from it.
  static constexpr float farthest_outside = 2.0F;

  static constexpr float near_cell(float p) {
    p = p < -farthest_outside ? -farthest_outside : p;
    return p > 1.0F + farthest_outside ? 1.0F + farthest_outside : p;
  }
  /// Returns the index in a window of a column or row of the box; end − first for one outside the window.
  static constexpr int stored(int index, int first, int end, int all) {
    int k = index - first;
    if (k < 0) {
      k += all;
    } else if (k >= all) {
      k -= all;
    }
    return std::min(k, end - first);
  }

  CellLayout layout_;
  CellWindow window_;
  std::size_t stride_ = 0;
  std::ptrdiff_t first_ = 0;  ///< row · stride_ + column of the first block
  std::size_t blocks_of_cells_ = 0;
  int left_of_first_ = 0, right_of_last_ = 0, below_first_ = 0, above_last_ = 0;
  double locals_per_length_ = 1.0;
  float local_width_ = 1.0F;
  float local_height_ = 1.0F;
};

}  // namespace gridlock
