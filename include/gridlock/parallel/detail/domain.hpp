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

/// The division of a box among the processes of a run into rectangles of cells, with about equally many points in each.
/// A process owns the points in its rectangle, and needs copies of the points in the rim around it.
///
///     ┌────┬──┬───┐      ┌ ─ ─ ─ ─ ─ ─ ─ ┐
///     │ 3  │4 │ 5 │        ┌───────────┐
///     ├──┬─┴──┼───┤      │ │ rectangle │ │
///     │0 │ 1  │ 2 │        └───────────┘
///     └──┴────┴───┘      └ ─ ─ ─ rim ─ ─ ┘
///
/// All processes construct it together, and get the same division.
class Domain {
 public:
  /// Divides the box into rectangles of cells, with rims as wide as the cutoff. (x[i], y[i]) are the points of this
  /// process.
  static Domain of_cells(Communicator& processes, CellLayout const& cells, double cutoff, std::span<double const> x,
                         std::span<double const> y);

  /// Divides the box into rectangles of whole tiles, with rims of one cell. for_each_point(visit) calls visit(p) for
  /// the points of this process.
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
  /// Returns the cells of the rectangle of a process and `margin` more to each side, without those beyond walls.
  [[nodiscard]] CellWindow window(std::size_t process, int margin) const;
  [[nodiscard]] CellWindow own_window(int margin) const { return window(processes_->rank(), margin); }
  /// Returns the tiles of this process. Contract: the division is one of tiles.
  [[nodiscard]] Tiling::Rectangle const& own_tiles() const { return own_tiles_; }
  /// Returns the number of points in the tiles of this process when the box was divided.
  [[nodiscard]] std::uint64_t points_of_own_tiles() const { return points_of_own_tiles_; }

  [[nodiscard]] std::size_t owner_of(Vector p) const { return owner_of_cell(cells_.cell_of(p)); }
  [[nodiscard]] std::size_t owner_of_cell(int cell) const;
  [[nodiscard]] bool is_own(Vector p) const {
    int const column = cells_.column_of(p.x);
    int const row = cells_.row_of(p.y);
    return (column >= own_.first_column) & (column < own_.end_column) & (row >= own_.first_row) & (row < own_.end_row);
  }
  /// Returns true for most points that this process owns and that are in no rim, else false. A fast test.
  [[nodiscard]] bool is_inside(Vector p) const {
    double const column = p.x * cells_.columns_per_length();
    double const row = p.y * cells_.rows_per_length();
    return (column > inside_.first_column) & (column < inside_.end_column) & (row > inside_.first_row) &
           (row < inside_.end_row);
  }
  /// Returns whether a point is in the rectangle or the rim of a process.
  [[nodiscard]] bool is_seen_by(std::size_t process, Vector p) const {
    return seen_[process].columns.contains(p.x * cells_.columns_per_length()) &&
           seen_[process].rows.contains(p.y * cells_.rows_per_length());
  }
  /// Calls visit(process) for each process that sees a point, or for none if is_inside(p).
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
  /// Returns the processes whose rims overlap the rectangle of this process.
  [[nodiscard]] std::span<std::size_t const> neighbours() const { return neighbours_; }
  [[nodiscard]] bool is_neighbour(std::size_t process) const;

  /// Returns a window with the cells of any layout that contain points of this process or its rim, and a few more
  /// cells.
  [[nodiscard]] CellWindow window_in(CellLayout const& layout) const;
  /// Returns true only if this process owns all points of a cell of any layout.
  [[nodiscard]] bool owns_cell(CellLayout const& layout, int column, int row) const;

 private:
  /// The width of the rim, in columns and rows of cells.
  struct Rim {
    double columns, rows;
  };
  /// The part of a side of the box that a process sees, in cells: its rectangle and the rim.
  struct Range {
    double first = 0.0;
    double length = -1.0;  ///< negative for an empty range
    double all = 0.0;      ///< length of a periodic side; 0 for a side with walls

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
  static Range range_of(int first, int end, double margin, int all, bool is_periodic);
  [[nodiscard]] CellWindow around(CellWindow const& rectangle, int columns, int rows) const;
  void find_neighbours();
  void find_inside();
  void find_owners();

  Communicator* processes_;
  CellLayout cells_;
  std::vector<CellWindow> rectangles_;  ///< one for each process
  Tiling::Rectangle own_tiles_;
  std::uint64_t points_of_own_tiles_ = 0;
  Rim rim_;
  CellWindow own_;
  Inside inside_{};
  std::vector<Seen> seen_;  ///< one for each process
  std::vector<std::size_t> neighbours_;
  std::vector<std::uint32_t> strip_of_row_;
  std::vector<std::vector<std::uint32_t>> owner_of_column_;  ///< for each strip of rectangles, the owner of each column
                                                             ///< of cells
};

/// Returns whether points crowd in cells, see is_crowd(pairs, points). (x[i], y[i]) are the points of this process,
/// with or without its rim; `points` is the number of points of all processes. All processes call it.
bool is_crowd(Domain const& domain, CellLayout const& layout, std::span<double const> x, std::span<double const> y,
              std::size_t points);

}  // namespace gridlock
