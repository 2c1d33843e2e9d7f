#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/scalar_turns.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "turn.hpp"

namespace gridlock {

class PackedTurns;

/// The results of one or several turns.
struct TurnResult {
  Counters counters;
  std::vector<std::uint32_t> not_local;  ///< rows of disks that have not taken their turn
};

/// A sequence of turns, which may belong to several tiles.
struct TurnsInOrder {
  std::uint32_t const* rows;         ///< row of each disk
  PackedGrid::Block* const* blocks;  ///< block that holds each disk
  std::uint8_t const* slots;         ///< slot of each disk in its block
  std::uint8_t const* places;        ///< index of each turn's result
  TurnResult* const* results;

  [[nodiscard]] TurnResult& result_of(std::size_t turn) const { return *results[places[turn]]; }
};

/// A kernel of PackedTurns::take_batch(). Its arguments fit into registers of the processor.
using TakeBatch = void (*)(PackedTurns& turns, TurnsInOrder const& order, std::size_t first, std::size_t count);

/// Takes one turn after the other.
void take_batch_scalar(PackedTurns& turns, TurnsInOrder const& order, std::size_t first, std::size_t count);
/// Returns the kernel for the instructions of this target, which the processor must have.
TakeBatch batch_kernel(Target target);

/// TurnLimits, and what the kernels of batches need besides.
struct TurnConstants : TurnLimits {
  TurnConstants(TurnView const& turn_view, PackedGrid const& grid, RadiusRange const& radii, double step_duration)
      : TurnLimits(turn_view.box, grid, radii, step_duration, turn_view.substeps),
        view(turn_view),
        layout(grid.layout()),
        radii_from_edge_x(view.box.is_periodic_x() ? 0.0 : 1.0),
        radii_from_edge_y(view.box.is_periodic_y() ? 0.0 : 1.0),
        last_x(view.box.is_periodic_x() ? std::nextafter(view.box.width(), 0.0) : view.box.width()),
        last_y(view.box.is_periodic_y() ? std::nextafter(view.box.height(), 0.0) : view.box.height()) {
    std::size_t k = 0;
    for (int const row : {-1, 0, 1}) {
      for (int const column : {-1, 0, 1}) {
        if (row == 0 && column == 0) continue;
        float* const shift = shift_of_block(k);
        std::fill_n(shift, PackedGrid::slots, -static_cast<float>(column) * grid.local_width());
        std::fill_n(shift + PackedGrid::slots, PackedGrid::slots, -static_cast<float>(row) * grid.local_height());
        ++k;
      }
    }
    for (std::size_t kind = 0; kind < kinds_of_cell; ++kind) block_offsets[kind] = block_offsets_of(grid, kind);
  }

  TurnView const& view;
  CellLayout const& layout;
  double radii_from_edge_x;  ///< radii that a disk keeps from the edges: 1 from walls, 0 from periodic edges
  double radii_from_edge_y;
  double last_x;  ///< largest x inside the box: the right wall, or just below a periodic edge
  double last_y;

  static constexpr std::size_t blocks_around = 8;
  /// Distances in memory from a cell's block to the blocks of the cells around it; the last two are its own block.
  using BlockOffsets = std::array<std::ptrdiff_t, blocks_around + 2>;
  /// Returns the offsets for a cell in this column and row of a periodic box; cells at an edge have other offsets than
  /// the rest. Between walls all cells have the offsets of inner cells: PackedGrid has empty blocks outside the box.
  [[nodiscard]] BlockOffsets const& block_offsets_at(int column, int row) const {
    std::size_t const in_columns = (column == 0 ? at_first : 0U) + (column + 1 == layout.columns() ? at_last : 0U);
    std::size_t const in_rows = (row == 0 ? at_first : 0U) + (row + 1 == layout.rows() ? at_last : 0U);
    return block_offsets[in_columns + kinds_of_column * in_rows];
  }

  static constexpr std::size_t at_first = 1;
  static constexpr std::size_t at_last = 2;
  static constexpr std::size_t kinds_of_column = at_first + at_last + 1;
  static constexpr std::size_t kinds_of_cell = kinds_of_column * kinds_of_column;
  std::array<BlockOffsets, kinds_of_cell> block_offsets;
  /// Returns the shift of a point, in coordinates relative to a cell, that makes it relative to cell k around: the
  /// shift of x once for each slot of a block, then that of y. The shift of cell 2 lies behind that of cell 0, that of
  /// 3 behind that of 1, so that the shifts of two cells can be read at once.
  [[nodiscard]] float const* shift_of_block(std::size_t k) const { return shifts.data() + place_of_shift(k); }
  [[nodiscard]] float* shift_of_block(std::size_t k) { return shifts.data() + place_of_shift(k); }
  alignas(64) std::array<float, 2 * blocks_around * PackedGrid::slots> shifts;

 private:
  static constexpr std::size_t place_of_shift(std::size_t k) {
    return 2 * PackedGrid::slots * (k / 4 * 4 + k % 2 * 2 + k / 2 % 2);
  }
  [[nodiscard]] BlockOffsets block_offsets_of(PackedGrid const& grid, std::size_t kind) const {
    auto const place = [](std::size_t edges, int count) {
      return (edges & at_first) != 0 ? 0 : (edges & at_last) != 0 ? count - 1 : 1;
    };
    std::size_t const in_columns = kind % kinds_of_column;
    std::size_t const in_rows = kind / kinds_of_column;
    int const column = place(in_columns, layout.columns());
    int const row = place(in_rows, layout.rows());
    // The index of the next cell, counted without branches, is one further away from the edge.
    auto const next = [](bool is_at_edge, int index, int beyond_edge, int step) {
      return is_at_edge ? beyond_edge - index : step;
    };
    std::array const columns{next((in_columns & at_first) != 0, column, grid.column_left_of(0), -1), 0,
                             next((in_columns & at_last) != 0, column, grid.column_right_of(column), 1)};
    std::array const rows{next((in_rows & at_first) != 0, row, grid.row_below(0), -1), 0,
                          next((in_rows & at_last) != 0, row, grid.row_above(row), 1)};
    BlockOffsets offsets{};
    std::size_t k = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (r == 1 && c == 1) continue;
        offsets[k++] = rows[r] * grid.blocks_in_row() + columns[c];
      }
    }
    return offsets;
  }
};

/// Takes turns on a packed grid, one by one or up to sixteen at once.
class PackedTurns : public ScalarTurns<PackedGrid> {
 public:
  PackedTurns(TurnView const& view, PackedGrid& grid, RadiusRange const& radii, double duration)
      : ScalarTurns(view, TurnLimits(view.box, grid, radii, duration, view.substeps), grid),
        constants_(view, grid, radii, duration),
        grid_(grid) {}

  [[nodiscard]] std::uint64_t substeps() const { return constants_.view.substeps; }
  [[nodiscard]] TurnConstants const& constants() const { return constants_; }
  [[nodiscard]] PackedGrid& grid() { return grid_; }

  static constexpr std::size_t largest_batch = 16;

  /// Number of rows and blocks behind the last turn of a batch that are read too; they must be valid.
  static constexpr std::size_t read_behind = 8;

  /// Takes turns `first` … first + count − 1 in their order, but leaves turns that are not local to the caller.
  /// Contract: no two disks have a common neighbour; count ≤ largest_batch. The bits are those of one turn after the
  /// other.
  void take_batch(TurnsInOrder const& order, std::size_t first, std::size_t count) {
    static TakeBatch const kernel = batch_kernel(target());
    // The kernels know no walls inside the box.
    (constants_.view.walls.empty() ? kernel : take_batch_scalar)(*this, order, first, count);
  }

 private:
  TurnConstants constants_;
  PackedGrid& grid_;
};

}  // namespace gridlock
