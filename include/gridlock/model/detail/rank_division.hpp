#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/population.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// The cells of a step of a synchronous model: coarse ones, and finer ones for agents that crowd, where those would
/// help.
struct CellsOfStep {
  CellLayout layout;
  std::optional<CellLayout> finer;
};
CellsOfStep cells_of_step(Box const& box, double cutoff, std::size_t agents);

/// How far around its rectangle a rank has to know agents, in columns and rows of cells.
struct Rim {
  double columns, rows;
};
/// One as wide as a cutoff.
Rim rim_of(CellLayout const& cells, double cutoff);

/// Which rank takes care of which part of the box: a rectangle of cells each. A rank has to know the agents of its
/// rectangle, and those of the rim around it.
class RankDivision {
 public:
  /// A rectangle for each rank, in columns and rows of the cells.
  RankDivision(CellLayout const& cells, std::vector<Tiling::Rectangle> rectangles, Rim const& rim, std::size_t rank);

  [[nodiscard]] CellLayout const& cells() const { return cells_; }
  [[nodiscard]] std::span<Tiling::Rectangle const> rectangles() const { return rectangles_; }

  [[nodiscard]] std::size_t owner_of(Vector p) const { return owner_of_cell(cells_.cell_of(p)); }
  [[nodiscard]] std::size_t owner_of_cell(int cell) const;
  /// Whether the rank of this process takes care of a point.
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
  /// Whether another rank has to know an agent at this point.
  [[nodiscard]] bool is_seen_by(std::size_t rank, Vector p) const {
    return seen_[rank].columns.contains(p.x * cells_.columns_per_length()) &&
           seen_[rank].rows.contains(p.y * cells_.rows_per_length());
  }
  /// The ranks whose rims overlap the own rectangle.
  [[nodiscard]] std::span<std::size_t const> neighbours() const { return neighbours_; }
  [[nodiscard]] bool is_neighbour(std::size_t rank) const;

  /// The cells of a layout, another one perhaps, that have agents of the rank and of its rim, and some more.
  [[nodiscard]] CellWindow window_of(CellLayout const& layout) const;
  /// Whether all points of a cell of a layout are certainly its own.
  [[nodiscard]] bool owns_cell(CellLayout const& layout, int column, int row) const;

 private:
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
  [[nodiscard]] Range range_of(std::size_t first, std::size_t end, double margin, int all) const;
  [[nodiscard]] CellWindow cells_of(Tiling::Rectangle const& rectangle, double more_columns, double more_rows) const;
  void find_inside();
  void find_owners();

  CellLayout cells_;
  std::vector<Tiling::Rectangle> rectangles_;
  double margin_columns_, margin_rows_;  ///< the width of a rim
  CellWindow own_;
  Inside inside_{};
  std::vector<Seen> seen_;  ///< of each rank
  std::vector<std::size_t> neighbours_;
  std::vector<std::uint32_t> strip_of_row_;
  std::vector<std::vector<std::uint32_t>> rank_of_column_;  ///< of each strip
};

/// The parts of all ranks, with about as many agents in each.
std::vector<Tiling::Rectangle> divide_among_ranks(Box const& box, CellLayout const& cells, std::span<double const> x,
                                                  std::span<double const> y, std::size_t ranks);

/// The same where each rank has some of the agents, those of (x[i], y[i]). All call it, and get the same.
std::vector<Tiling::Rectangle> divide_among_ranks(Communicator& ranks, Box const& box, CellLayout const& cells,
                                                  std::span<double const> x, std::span<double const> y);

/// Whether points crowd, in cells of which all are stored; see is_crowd().
bool is_crowd(CellLayout const& layout, std::span<double const> x, std::span<double const> y);

/// What several ranks have counted in the coarse cells of a step.
class CellCounts {
 public:
  /// Counts the points of one rank: `counts(row)` says whether a row is its own.
  template <class Counts>
  CellCounts(RankDivision const& division, CellLayout const& layout, std::span<double const> x,
             std::span<double const> y, Counts counts)
      : numbers_(layout, division.window_of(layout)), agents_(numbers_.count(), 0) {
    for (std::size_t row = 0; row < x.size(); ++row) {
      if (counts(row)) ++agents_[numbers_.number_of(layout.column_of(x[row]), layout.row_of(y[row]))];
    }
    add_up(division, layout);
  }

  /// A cell that ranks may share, and the agents that one of them has there.
  struct SharedCell {
    std::uint32_t cell;
    std::uint32_t agents;
  };
  [[nodiscard]] std::uint64_t pairs() const { return pairs_; }
  [[nodiscard]] std::span<SharedCell const> shared() const { return shared_; }

  /// Pairs in the same cell, where ranks share it.
  static std::uint64_t pairs_in(std::vector<SharedCell> cells);

 private:
  void add_up(RankDivision const& division, CellLayout const& layout);

  CellNumbers numbers_;
  std::vector<std::uint32_t> agents_;
  std::uint64_t pairs_ = 0;  ///< in cells of this rank alone
  std::vector<SharedCell> shared_;
};

/// A set of Ids, to ask for each of many agents whether it is one of a few.
class IdSet {
 public:
  /// Sorts them, and drops repeats.
  explicit IdSet(std::vector<Id> ids);

  [[nodiscard]] std::span<Id const> sorted() const { return ids_; }
  [[nodiscard]] bool contains(Id id) const {
    std::uint64_t const bit = id & mask_;
    return (bits_[bit / 64] >> bit % 64 & 1U) != 0 && is_among(id);
  }

 private:
  [[nodiscard]] bool is_among(Id id) const;

  std::vector<Id> ids_;
  std::uint64_t mask_ = 63;
  std::vector<std::uint64_t> bits_;  ///< most Ids are told from all others by their last bits
};

}  // namespace gridlock
