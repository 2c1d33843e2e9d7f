#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/headings.hpp"
#include "engine/hot_disks.hpp"
#include "engine/packed_turns.hpp"
#include "engine/tiled/fetch_ahead.hpp"
#include "gridlock/grid/detail/class_order.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock::tiled {

/// Steps after which disks are sorted by cell again; they drift less than a cell in that time.
constexpr std::uint64_t steps_between_sorts = 100;

/// The numbers that all turns of a run have in common.
struct TurnRule {
  Box box;
  double duration;  ///< duration of a step
  std::uint64_t substeps;
  CollisionRule contact;
  RadiusRange radii;
  HeadingRule heading = {};
  Obstacles walls = {};  ///< walls inside the box
};

/// Returns whether a tile is its own neighbour around a periodic box: cells three apart may share a neighbour.
bool goes_around_box(CellLayout const& layout, Tiling const& tiling);

/// A disk that could jump over another in a sub-step.
struct TooFast {
  std::uint32_t row_in_state;
  double displacement;  ///< displacement in a sub-step, in units of length
};

/// The results of one tile in one step, on a cache line of its own, since threads write to tiles side by side. Disks
/// that are not local take their turns at the end of the step.
struct alignas(64) TileResult : TurnResult {
  std::optional<TooFast> too_fast;  ///< the first disk that could jump over another
};

/// Takes the turns of the disks of some tiles, step after step.
class Steps {
 public:
  /// `disks` are all disks of the window, in any order; those in `tiles`, in ascending order, take turns.
  Steps(HotDisks&& disks, TurnRule const& rule, CellLayout const& layout, Tiling const& tiling,
        CellWindow const& window, std::vector<std::uint32_t> tiles);
  Steps(Steps const&) = delete;
  Steps& operator=(Steps const&) = delete;

  void begin_step(std::uint64_t step) {
    marks_of_turned_ ^= all_slots;
    if (rule_.heading.is_on()) heading_ = heading_step(rule_.heading, step);
  }

  /// Takes the turns in these tiles, except for disks too fast for their tile. Different parts may be taken at once.
  void take_part(Tiling::Part const& part);

  /// Takes the turn of a disk that was too fast for its tile, and adds its counters to the results of that tile.
  void take_late(std::uint32_t row, TileResult& result);

  /// Results of the tiles that take turns, in the order of `tiles`.
  [[nodiscard]] std::vector<TileResult>& results() { return results_; }
  [[nodiscard]] std::vector<TileResult> const& results() const { return results_; }
  [[nodiscard]] TileResult& result_of(std::uint32_t tile) { return results_[place_of_tile_[tile]]; }
  [[nodiscard]] std::vector<std::uint32_t> const& tiles() const { return tiles_; }

  /// Returns whether a sub-step at this speed is shorter than the contact distance with the smallest disk.
  [[nodiscard]] bool is_short_at(double squared_speed, double radius) const;
  /// Returns the number of cells to each side in which a disk of this speed may meet others or end.
  [[nodiscard]] int reach(double radius, double squared_speed) const;

  [[nodiscard]] HotDisks const& disks() const { return disks_; }
  /// Returns all disks. Afterwards no further step can be taken.
  [[nodiscard]] LargeArray<DiskInTurn> take_disks() { return disks_.take(); }
  [[nodiscard]] PackedGrid const& grid() const { return grid_; }

  // Cells as messages between processes hold them:

  [[nodiscard]] bool has_turned(std::uint32_t row) const;
  /// Replaces the disks of a cell by these disks.
  void replace_cell(int cell, std::span<DiskInTurn const> disks, std::span<std::uint8_t const> has_turned);

 private:
  void insert(DiskInTurn const& disk, bool has_turned);
  void set_mark(std::uint32_t row, bool has_turned);

  TurnRule rule_;
  Tiling const& tiling_;
  HotDisks disks_;
  HeadingStep heading_{};  ///< of the present step
  TurnView view_;
  PackedGrid grid_;
  PackedTurns turns_;
  Cutoff cutoff_;
  std::size_t group_size_;
  std::size_t team_size_;  ///< tiles that take turns at once
  /// Each disk has a mark that tells whether it has taken its turn in this step; the meaning of the mark is inverted at
  /// every step, so that no mark needs to be reset.
  static constexpr unsigned all_slots = (1U << PackedGrid::slots) - 1U;
  unsigned marks_of_turned_ = 0;             ///< value of the marks of disks that have taken their turn
  std::vector<std::uint32_t> id_indices_;    ///< copy of DiskInTurn::id_index in an array of its own
  std::vector<std::uint32_t> free_rows_;     ///< rows without a disk
  std::vector<std::uint32_t> rows_of_cell_;  ///< scratch buffer of replace_cell()
  std::vector<std::uint32_t> tiles_;
  std::vector<std::uint32_t> place_of_tile_;  ///< index among the tiles that take turns
  std::vector<TileResult> results_;
  std::vector<std::uint32_t> turns_of_tile_;  ///< approximate number of turns in each tile
};

/// The order of the cells in a rectangle of tiles: tile by tile, and row by row in a tile.
class CellOfTurn {
 public:
  CellOfTurn(CellLayout const& layout, Tiling const& tiling, std::span<std::uint32_t const> tiles);

  /// Returns the indices of points in this order of cells. Contract: all points lie in these tiles.
  template <class Position>
  [[nodiscard]] std::vector<std::uint32_t> order(std::size_t count, Position position_of) const {
    auto const turn_of = [&](std::size_t i) {
      Vector const p = position_of(i);
      return turns_[index_of(layout_.column_of(p.x), layout_.row_of(p.y))];
    };
    std::vector<std::uint32_t> begin(turns_.size() + 1, 0);
    for (std::size_t i = 0; i < count; ++i) ++begin[turn_of(i) + 1];
    for (std::size_t cell = 0; cell < turns_.size(); ++cell) begin[cell + 1] += begin[cell];
    std::vector<std::uint32_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[begin[turn_of(i)]++] = static_cast<std::uint32_t>(i);
    return order;
  }

 private:
  [[nodiscard]] std::size_t index_of(int column, int row) const {
    return static_cast<std::size_t>(row - first_row_) * columns_ + static_cast<std::size_t>(column - first_column_);
  }

  CellLayout layout_;
  int first_column_ = 0;
  int first_row_ = 0;
  std::size_t columns_ = 0;
  std::vector<std::uint32_t> turns_;
};

}  // namespace gridlock::tiled
