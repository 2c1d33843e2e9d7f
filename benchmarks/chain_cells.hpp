#pragma once

// A cell is so narrow (side ≤ σ/√2) that it holds one disk at most. So a grid of floats relative to the cells is all
// there is: no counts, no lists, no names of disks. One row of cells is one load. The grid has a margin of copies.

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock::benchmark {

constexpr float nowhere = 1e10F;  ///< both coordinates of an empty cell

/// A cell of the grid: its place in the columns, its row and its column.
struct Cell {
  int place;
  int row;
  int column;
};

/// Cells of at most one disk, σ = 1, with a margin of copies at each edge.
class Cells {
 public:
  static constexpr int margin = 3;

  Cells(double side, std::vector<Vector> const& disks, std::vector<Vector> const& velocities)
      : cells_(static_cast<int>(std::floor(side * std::numbers::sqrt2 * (1.0 + 1e-6))) + 1),
        stride_(cells_ + 2 * margin + 8),
        width_(side / cells_) {
    auto const size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(cells_ + 2 * margin);
    rough_x.assign(size, nowhere);
    rough_y.assign(size, nowhere);
    x.assign(size, 0.0);
    y.assign(size, 0.0);
    u.assign(velocities.empty() ? 0 : size, 0.0);
    v.assign(velocities.empty() ? 0 : size, 0.0);
    for (std::size_t i = 0; i < disks.size(); ++i) {
      int const column = std::min(static_cast<int>(disks[i].x / width_), cells_ - 1);
      int const row = std::min(static_cast<int>(disks[i].y / width_), cells_ - 1);
      Cell const cell = at(row, column);
      if (rough_x[cell.place] != nowhere) std::abort();
      put(cell, disks[i].x - column * width_, disks[i].y - row * width_);
      if (!velocities.empty()) {
        u[cell.place] = velocities[i].x;
        v[cell.place] = velocities[i].y;
      }
    }
  }

  [[nodiscard]] Cell at(int row, int column) const { return {(row + margin) * stride_ + column + margin, row, column}; }
  [[nodiscard]] int stride() const { return stride_; }
  [[nodiscard]] double width() const { return width_; }

  /// The cell so many rows and columns away, around the box.
  [[nodiscard]] Cell beside(Cell cell, int step, int rows, int columns) const {
    Cell other{cell.place + step, cell.row + rows, cell.column + columns};
    if (static_cast<unsigned>(other.row) >= static_cast<unsigned>(cells_) ||
        static_cast<unsigned>(other.column) >= static_cast<unsigned>(cells_)) [[unlikely]] {
      other = at((other.row + cells_) % cells_, (other.column + cells_) % cells_);
    }
    return other;
  }
  /// Writes the disk of a cell, with its copies.
  void put(Cell cell, double new_x, double new_y) {
    x[cell.place] = new_x;
    y[cell.place] = new_y;
    put_rough(cell, static_cast<float>(new_x), static_cast<float>(new_y));
  }
  void empty(Cell cell) { put_rough(cell, nowhere, nowhere); }
  /// Returns a disk chosen at random.
  [[nodiscard]] Cell random_disk(RandomStream& random) const {
    for (;;) {
      auto const k = random.below(static_cast<std::uint64_t>(cells_) * static_cast<std::uint64_t>(cells_));
      Cell const cell = at(static_cast<int>(k) / cells_, static_cast<int>(k) % cells_);
      if (rough_x[cell.place] != nowhere) return cell;
    }
  }
  [[nodiscard]] std::vector<Vector> disks() const {
    std::vector<Vector> result;
    for (int row = 0; row < cells_; ++row) {
      for (int column = 0; column < cells_; ++column) {
        int const k = at(row, column).place;
        if (rough_x[k] != nowhere) result.push_back({column * width_ + x[k], row * width_ + y[k]});
      }
    }
    return result;
  }

  std::vector<float> rough_x, rough_y;  ///< relative to the corner of the cell, rounded, with copies
  std::vector<double> x, y;             ///< the same, not rounded, without copies; anything in empty cells
  std::vector<double> u, v;             ///< velocities of Newtonian chains; 0 in the margin

 private:
  void put_rough(Cell cell, float new_x, float new_y) {
    rough_x[cell.place] = new_x;
    rough_y[cell.place] = new_y;
    auto const inner = static_cast<unsigned>(cells_ - 2 * margin);
    if (static_cast<unsigned>(cell.row - margin) >= inner || static_cast<unsigned>(cell.column - margin) >= inner)
        [[unlikely]] {
      copy(cell);
    }
  }
  [[gnu::noinline]] void copy(Cell cell) {
    for (int const row : {cell.row - cells_, cell.row, cell.row + cells_}) {
      if (row < -margin || row >= cells_ + margin) continue;
      for (int const column : {cell.column - cells_, cell.column, cell.column + cells_}) {
        if (column < -margin || column >= cells_ + margin) continue;
        int const k = at(row, column).place;
        rough_x[k] = rough_x[cell.place];
        rough_y[k] = rough_y[cell.place];
      }
    }
  }

  int cells_;
  int stride_;
  double width_;
};

using Wide = __m512;

inline Wide two_rows(float const* lower, float const* upper) {
  return _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(lower)), _mm256_loadu_ps(upper), 1);
}
inline Wide four_rows(float const* first, int stride) {
  Wide rows = _mm512_castps128_ps512(_mm_loadu_ps(first));
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + stride), 1);
  rows = _mm512_insertf32x4(rows, _mm_loadu_ps(first + 2 * stride), 2);
  return _mm512_insertf32x4(rows, _mm_loadu_ps(first + 3 * stride), 3);
}
using Keys = __m512i;
/// Lower bounds of the paths to contact, (b − √(r² − c²)), of disks at b along and c across the way of the moving disk,
/// with the lane in the last six bits, so that the least key names its lane. Single precision errs by less than the
/// slack in b, and in r² − c² by less than the slack that is part of `squared`.
inline Keys keys(Wide along, Wide across, Wide squared, Wide slack, Keys lanes) {
  Wide const under_root = _mm512_fnmadd_ps(across, across, squared);
  __mmask16 const ahead = _mm512_cmp_ps_mask(along, slack, _CMP_GT_OQ);
  __mmask16 const hits = _mm512_mask_cmp_ps_mask(ahead, under_root, _mm512_setzero_ps(), _CMP_GT_OQ);
  Wide const path = _mm512_max_ps(_mm512_sub_ps(along, _mm512_sqrt_ps(under_root)), _mm512_setzero_ps());
  Keys const cut = _mm512_and_epi32(_mm512_castps_si512(path), _mm512_set1_epi32(~63));
  return _mm512_mask_or_epi32(_mm512_set1_epi32(std::numeric_limits<int>::max()), hits, cut, lanes);
}
/// The key of a path rounded up: keys of paths that may be shorter are less.
inline Keys above(double path) {
  auto const rounded = static_cast<float>(path) * (1.0F + 1e-6F);
  return _mm512_or_epi32(_mm512_castps_si512(_mm512_set1_ps(rounded)), _mm512_set1_epi32(63));
}
inline std::uint64_t lanes_below(Keys bound, Keys first, Keys second) {
  return _mm512_cmple_epu32_mask(first, bound) | static_cast<std::uint64_t>(_mm512_cmple_epu32_mask(second, bound))
                                                     << 16U;
}

/// Lanes of a window of cells: places relative to the cell of the moving disk, and steps from cell to cell.
struct Window {
  alignas(64) float column[64];
  alignas(64) float row[64];
  alignas(64) int lane[64];
  int step[64];
  int rows[64];
  int columns[64];
};
/// A window of rows and columns, `lanes` cells of a row side by side.
inline Window window(Cells const& cells, int first_row, int rows, int first_column, int columns, int lanes) {
  Window result{};
  for (int k = 0; k < 64; ++k) {
    int const row = first_row + k / lanes;
    int const column = first_column + k % lanes;
    bool const counts = k / lanes < rows && k % lanes < columns && (row != 0 || column != 0);
    result.row[k] = counts ? static_cast<float>(row * cells.width()) : nowhere;
    result.column[k] = counts ? static_cast<float>(column * cells.width()) : nowhere;
    result.lane[k] = k;
    result.step[k] = row * cells.stride() + column;
    result.rows[k] = row;
    result.columns[k] = column;
  }
  return result;
}

/// A disk that has moved, to be written once the cells around the next one have been read: a wide load that follows a
/// narrow store to the same place would wait for it. The next disk moves away from this one, so it need not see it.
struct Pending {
  Cell from;
  Cell to;
  double x;
  double y;

  void write(Cells& cells) const {
    if (from.place != to.place) cells.empty(from);
    cells.put(to, x, y);
  }
};

}  // namespace gridlock::benchmark
