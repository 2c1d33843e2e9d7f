#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

/// The division of a box among the processes of a run: a rectangle of cells for each, with about as many points in
/// each. A point belongs to the process in whose rectangle it is, and those in whose rim it is have to know it.
///
///     ┌────┬──┬───┐      ┌ ─ ─ ─ ─ ─ ─ ─ ┐
///     │ 3  │4 │ 5 │        ┌───────────┐
///     ├──┬─┴──┼───┤      │ │ rectangle │ │
///     │0 │ 1  │ 2 │        └───────────┘
///     └──┴────┴───┘      └ ─ ─ ─ rim ─ ─ ┘
///
/// All processes construct it together, and get the same.
class Domain {
 public:
  /// Rectangles of cells, and a rim as wide as the cutoff. (x[i], y[i]) are the points of this process.
  static Domain of_cells(Communicator& processes, CellLayout const& cells, double cutoff, std::span<double const> x,
                         std::span<double const> y);

  /// Rectangles of whole tiles, and a rim of one cell. for_each_point(visit) calls visit(p) for the points of this
  /// process.
  template <class ForEachPoint>
  static Domain of_tiles(Communicator& processes, CellLayout const& cells, ForEachPoint for_each_point) {
    Tiling const tiling(cells);
    TileFinder const finder(cells, tiling);
    std::vector<std::uint64_t> points_of_tiles(tiling.tiles().size(), 0);
    for_each_point([&](Vector p) { ++points_of_tiles[finder.tile_of(p)]; });
    all_sum(processes, points_of_tiles);
    return of_whole_tiles(processes, cells, tiling, points_of_tiles);
  }

  [[nodiscard]] Communicator& processes() const { return *processes_; }
  [[nodiscard]] CellLayout const& cells() const { return cells_; }
  /// The cells of the rectangle of a process and `margin` more to each side, as far as the box has them.
  [[nodiscard]] CellWindow window(std::size_t process, int margin) const;
  /// The window of this process.
  [[nodiscard]] CellWindow own_window(int margin) const { return window(processes_->rank(), margin); }
  /// The tiles of this process, where the rectangles are whole tiles.
  [[nodiscard]] Tiling::Rectangle const& own_tiles() const { return own_tiles_; }
  /// The number of points in them, in the whole system.
  [[nodiscard]] std::uint64_t points_of_own_tiles() const { return points_of_own_tiles_; }

  [[nodiscard]] std::size_t owner_of(Vector p) const { return owner_of_cell(cells_.cell_of(p)); }
  [[nodiscard]] std::size_t owner_of_cell(int cell) const;
  /// Whether a point belongs to this process.
  [[nodiscard]] bool is_own(Vector p) const {
    int const column = cells_.column_of(p.x);
    int const row = cells_.row_of(p.y);
    return (column >= own_.first_column) & (column < own_.end_column) & (row >= own_.first_row) & (row < own_.end_row);
  }
  /// Whether a point is its own and in no rim; false for some more.
  [[nodiscard]] bool is_inside(Vector p) const {
    double const column = p.x * cells_.columns_per_length();
    double const row = p.y * cells_.rows_per_length();
    return (column > inside_.first_column) & (column < inside_.end_column) & (row > inside_.first_row) &
           (row < inside_.end_row);
  }
  /// Whether a process has a point in its rectangle or in its rim.
  [[nodiscard]] bool is_seen_by(std::size_t process, Vector p) const {
    return seen_[process].columns.contains(p.x * cells_.columns_per_length()) &&
           seen_[process].rows.contains(p.y * cells_.rows_per_length());
  }
  /// Calls visit(process) for each process that sees a point which is not inside.
  template <class Visit>
  void for_each_that_sees(Vector p, Visit visit) const {
    if (is_inside(p)) return;
    auto const ask = [&](std::size_t process) {
      if (is_seen_by(process, p)) visit(process);
    };
    if (is_own(p)) {
      for (std::size_t const process : neighbours_) ask(process);
    } else {
      for (std::size_t process = 0; process < seen_.size(); ++process) ask(process);
    }
  }
  /// The processes whose rims overlap the rectangle of this one.
  [[nodiscard]] std::span<std::size_t const> neighbours() const { return neighbours_; }
  [[nodiscard]] bool is_neighbour(std::size_t process) const;

  /// The cells of a layout, another one perhaps, that have points of this process and of its rim, and some more.
  [[nodiscard]] CellWindow window_in(CellLayout const& layout) const;
  /// Whether all points of a cell of a layout certainly belong to this process.
  [[nodiscard]] bool owns_cell(CellLayout const& layout, int column, int row) const;

 private:
  /// How far around its rectangle a process has to know points, in columns and rows of cells.
  struct Rim {
    double columns, rows;
  };
  /// Part of a side, counted in cells, with the rim.
  struct Range {
    double first = 0.0;
    double length = -1.0;  ///< negative: nothing
    double all = 0.0;      ///< of a periodic side; 0: the side ends

    [[nodiscard]] bool contains(double place) const {
      double from_first = place - first;
      if (all > 0.0) {
        if (from_first < 0.0) from_first += all;
        if (from_first >= all) from_first -= all;
      }
      return from_first >= 0.0 && from_first <= length;
    }
  };
  struct Seen {
    Range columns, rows;
  };
  struct Inside {
    double first_column, end_column, first_row, end_row;
  };
  Domain(Communicator& processes, CellLayout const& cells, std::vector<CellWindow> rectangles, Rim const& rim);
  static Domain of_whole_tiles(Communicator& processes, CellLayout const& cells, Tiling const& tiling,
                               std::span<std::uint64_t const> points_of_tiles);
  [[nodiscard]] Range range_of(int first, int end, double margin, int all) const;
  [[nodiscard]] CellWindow around(CellWindow const& rectangle, int columns, int rows) const;
  void find_neighbours();
  void find_inside();
  void find_owners();

  Communicator* processes_;
  CellLayout cells_;
  std::vector<CellWindow> rectangles_;  ///< of each process
  Tiling::Rectangle own_tiles_;
  std::uint64_t points_of_own_tiles_ = 0;
  Rim rim_;
  CellWindow own_;
  Inside inside_{};
  std::vector<Seen> seen_;  ///< of each process
  std::vector<std::size_t> neighbours_;
  std::vector<std::uint32_t> strip_of_row_;
  std::vector<std::vector<std::uint32_t>> owner_of_column_;  ///< of each strip
};

/// Whether points crowd in cells, see is_crowd(pairs, points). (x[i], y[i]) are those of this process and, perhaps, of
/// its rim; `points` is the number of those of all. All processes call it.
bool is_crowd(Domain const& domain, CellLayout const& layout, std::span<double const> x, std::span<double const> y,
              std::size_t points);

}  // namespace gridlock
