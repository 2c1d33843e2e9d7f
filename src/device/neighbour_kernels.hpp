#pragma once

#include <cstddef>
#include <cstdint>

#include "device/backend.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/row_block.hpp"

/// \file
/// Points sorted by cells, in a cell by their numbers, as CellList sorts them, and the searches among them.

namespace gridlock::device {

/// Numbers of points that the device does not search.
struct PointFaults {
  std::uint64_t pairs_in_cells;  ///< see is_crowd()
  std::uint32_t not_finite;
};

/// The points, as all kernels of a search read and write them.
struct PointsMemory {
  Box box;
  CellLayout layout;
  double const* x_given;
  double const* y_given;
  std::uint32_t* cell_of;  ///< cell of each point
  std::uint32_t* first;    ///< first row of each cell, and one entry more
  std::uint32_t* filled;   ///< rows of each cell that have a point
  std::uint32_t* index;    ///< number of the point in each row
  double* x;               ///< coordinates of the image in the box of the point in each row
  double* y;
  PointFaults* faults;

  [[nodiscard]] constexpr std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns()) +
           static_cast<std::size_t>(column);
  }
};

struct FindCell {
  PointsMemory points;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t i) const {
    Vector p{points.x_given[i], points.y_given[i]};
    if (!(p.x - p.x == 0.0) || !(p.y - p.y == 0.0)) {
      fetch_add(points.faults->not_finite, 1);
      p = {};
    }
    std::size_t const cell = points.cell(points.layout.column_of(p.x), points.layout.row_of(p.y));
    points.cell_of[i] = static_cast<std::uint32_t>(cell);
    fetch_add(points.first[cell + 1], 1);
  }
};

struct CountPairsInCell {
  PointsMemory points;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t cell) const {
    std::uint64_t const count = points.first[cell + 1];
    if (count > 1) add(points.faults->pairs_in_cells, count * (count - 1) / 2);
  }
};

struct PutIntoCell {
  PointsMemory points;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t i) const {
    std::uint32_t const cell = points.cell_of[i];
    points.index[points.first[cell] + fetch_add(points.filled[cell], 1)] = static_cast<std::uint32_t>(i);
  }
};

struct SortCell {
  PointsMemory points;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t cell) const {
    std::uint32_t* const index = points.index;
    std::size_t const first = points.first[cell];
    std::size_t const end = points.first[cell + 1];
    for (std::size_t row = first + 1; row < end; ++row) {
      std::uint32_t const point = index[row];
      std::size_t hole = row;
      for (; hole > first && index[hole - 1] > point; --hole) index[hole] = index[hole - 1];
      index[hole] = point;
    }
    for (std::size_t row = first; row < end; ++row) {
      Vector const p = points.layout.image_in_cell({points.x_given[index[row]], points.y_given[index[row]]});
      points.x[row] = p.x;
      points.y[row] = p.y;
    }
  }
};

/// The partners of a point: all neighbours, or those of them in later rows of its own cell and in half of the cells
/// around, so that each pair is found once.
enum class Partners { all, later };

/// Calls visit(row) for each partner of the point in a row that is nearer than the cutoff, in the order of
/// find_neighbours() and add_pairs_of_cells().
template <Partners partners, class Visit>
constexpr void for_each_partner(PointsMemory const& points, double squared_cutoff, std::size_t row, Visit visit) {
  Vector const p{points.x[row], points.y[row]};
  int const column = points.layout.column_of(p.x);
  int const cell_row = points.layout.row_of(p.y);
  RowBlocks const blocks(points.layout, [&](int c, int r) -> std::size_t { return points.first[points.cell(c, r)]; });
  RowBlock const block = partners == Partners::all ? blocks.around(column, cell_row) : blocks.after(column, cell_row);
  for (std::size_t k = 0; k < block.count; ++k) {
    std::size_t const first = partners == Partners::later && k == 0 ? row + 1 : block.rows[k].first;
    for (std::size_t other = first; other < block.rows[k].end; ++other) {
      if (other == row) continue;
      Vector const q{points.x[other], points.y[other]};
      Vector const separation = block.is_at_edge ? points.box.displacement_inside(p, q) : q - p;
      if (squared_length(separation) < squared_cutoff) visit(other);
    }
  }
}

/// Counts the partners of each point; counts[0] stays 0. Neighbours are counted for points, pairs for rows.
template <Partners partners>
struct CountPartners {
  PointsMemory points;
  double squared_cutoff;
  std::uint64_t* counts;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t row) const {
    std::uint64_t count = 0;
    for_each_partner<partners>(points, squared_cutoff, row, [&](std::size_t) { ++count; });
    counts[(partners == Partners::all ? points.index[row] : row) + 1] = count;
  }
};

struct WriteNeighbours {
  PointsMemory points;
  double squared_cutoff;
  std::uint64_t const* begin;
  std::uint32_t* neighbours;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t row) const {
    std::uint64_t k = begin[points.index[row]];
    for_each_partner<Partners::all>(points, squared_cutoff, row,
                                    [&](std::size_t other) { neighbours[k++] = points.index[other]; });
  }
};

struct WritePairs {
  PointsMemory points;
  double squared_cutoff;
  std::uint64_t const* begin;
  std::uint32_t* first;
  std::uint32_t* second;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t row) const {
    std::uint64_t k = begin[row];
    for_each_partner<Partners::later>(points, squared_cutoff, row, [&](std::size_t other) {
      first[k] = points.index[row];
      second[k++] = points.index[other];
    });
  }
};

}  // namespace gridlock::device
