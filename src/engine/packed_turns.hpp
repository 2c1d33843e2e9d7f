#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "grid/lane_bits.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "turn.hpp"

namespace gridlock {

/// The largest distance at which a disk at the start of its turn can meet a centre: contact distance plus displacement.
class Cutoff {
 public:
  Cutoff(Box const& box, double largest_radius, double duration, std::uint64_t substeps)
      : largest_radius_(largest_radius),
        duration_(duration),
        // Every sub-step may round the position by a last digit of the box side; these errors add up.
        rounding_(static_cast<double>(substeps) * std::numeric_limits<double>::epsilon() *
                  std::max(box.width(), box.height())) {}

  [[nodiscard]] double of(double radius, double squared_speed) const {
    return contact(radius) + std::sqrt(squared_speed) * duration_ + rounding_;
  }
  /// The largest contact distance of a disk.
  [[nodiscard]] double contact(double radius) const { return radius + largest_radius_; }
  [[nodiscard]] double rounding() const { return rounding_; }

 private:
  double largest_radius_;
  double duration_;
  double rounding_;
};

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

/// Numbers that do not change from turn to turn.
struct TurnConstants {
  TurnConstants(TurnView const& turn_view, PackedGrid const& grid, RadiusRange const& radii, double step_duration)
      : view(turn_view),
        layout(grid.layout()),
        cutoff(view.box, radii.largest, step_duration, view.substeps),
        duration(step_duration),
        room(std::min(layout.cell_width(), layout.cell_height()) * (1.0 - 1e-9)),
        limit_per_area(1.001 * grid.locals_per_length() * grid.locals_per_length()),
        limit_error(grid.local_limit(0.0)),
        inner_columns(static_cast<unsigned>(std::max(0, layout.columns() - 2))),
        inner_rows(static_cast<unsigned>(std::max(0, layout.rows() - 2))),
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
  Cutoff cutoff;
  double duration;
  double room;  ///< distance for contact and displacement within which a turn is local
  double limit_per_area;
  float limit_error;
  unsigned inner_columns;  ///< columns that are not at an edge
  unsigned inner_rows;
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

/// Takes turns on a packed grid. The candidates of a disk are found once for each turn, and only those it may meet.
///
/// During its displacement w, a disk at distance vector −d from another and not in contact, |d| ≥ c, comes as near as c
/// after a part s ≤ 1 of it only if |d − s w|² < c², thus |d|² − c² < 2 s d·w − s² w² ≤ 2 s d·w. The left side is not
/// below 0, so neither is d·w, and the bound holds for s = 1 as well: |d − w|² < c² + w². So one comparison per
/// candidate, relative to the end of the displacement, is enough; in a dense system one candidate in twelve is left.
class PackedTurns {
 public:
  PackedTurns(TurnView const& view, PackedGrid& grid, RadiusRange const& radii, double duration)
      : constants_(view, grid, radii, duration), grid_(grid) {}

  /// Returns whether the disk stays in the 3×3 block around its cell during its turn and meets only disks in the block.
  [[nodiscard]] bool is_local(std::size_t i, double squared_speed) const {
    double const displacement =
        constants_.room - constants_.cutoff.contact(constants_.view.disks[i].radius) - constants_.cutoff.rounding();
    return displacement > 0.0 &&
           squared_speed * constants_.duration * constants_.duration <= displacement * displacement;
  }

  /// The candidates of a turn that has not been taken yet.
  struct Prepared {
    std::uint64_t near;  ///< bit slots·k + s is set where slot s of cell k around may be met; the last k is its own
    std::uint32_t disk;
    bool is_far_from_edge;   ///< and from walls inside the box
    bool needs_more_blocks;  ///< true where a cell around has more disks than a block holds
  };

  /// Finds the candidates of a disk. Contract: is_local(). They stay valid while the disks of the 3×3 block stay as
  /// they are, so disks three cells apart can be prepared together, which hides the time that memory takes.
  [[nodiscard]] Prepared prepare(std::size_t i) const { return prepare(i, grid_.block_of(i), grid_.slot_of(i)); }
  /// As prepare(i), for a disk known to be in this slot.
  [[nodiscard]] Prepared prepare(std::size_t i, PackedGrid::Block const& home, std::uint32_t slot) const {
    Around const around = around_of(home);
    // One cell is wider than displacement and contact distance, so a disk in an inner cell cannot get to the edge.
    bool const is_far_from_edge = static_cast<unsigned>(home.column - 1) < constants_.inner_columns &&
                                  static_cast<unsigned>(home.row - 1) < constants_.inner_rows && !may_meet_wall(i);
    return {.near = find_near(i, home, slot, around),
            .disk = static_cast<std::uint32_t>(i),
            .is_far_from_edge = is_far_from_edge,
            .needs_more_blocks = grid_.has_further_blocks() && has_further_blocks(around)};
  }

  void take(Prepared const& turn, Counters& counters) {
    if (turn.needs_more_blocks) {
      take_any(turn.disk, counters);
      return;
    }
    if (turn.is_far_from_edge) {
      take_among<EdgeOfTurn::is_far>(turn, counters);
    } else {
      take_among<EdgeOfTurn::may_be_met>(turn, counters);
    }
    grid_.move(turn.disk, constants_.view.disks[turn.disk].position);
  }

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
    (constants_.view.walls == nullptr ? kernel : take_batch_scalar)(*this, order, first, count);
  }

  /// Takes the turn of disk i, however far it moves.
  void take_any(std::size_t i, Counters& counters) {
    double const distance =
        constants_.cutoff.of(constants_.view.disks[i].radius, squared_length(constants_.view.disks[i].velocity));
    int const columns = constants_.layout.columns_within(distance);
    int const rows = constants_.layout.rows_within(distance);
    int const cell = grid_.cell_of(i);
    take_turn(constants_.view, i, counters, [&](Partner& partner) {
      grid_.for_each_in_block(cell, columns, rows, [&](std::size_t j) { partner.consider(j); });
    });
    grid_.move(i, constants_.view.disks[i].position);
  }

 private:
  using Block = PackedGrid::Block;
  /// The blocks of the cells around a disk's cell, row by row from below left, then of its own cell.
  using Around = std::array<Block const*, 9>;
  static constexpr std::size_t slots = PackedGrid::slots;
  static constexpr std::size_t own = TurnConstants::blocks_around;

  /// Returns whether the disk may touch a wall inside the box in its turn.
  [[nodiscard]] bool may_meet_wall(std::size_t i) const {
    if (constants_.view.walls == nullptr) return false;
    DiskInTurn const& disk = constants_.view.disks[i];
    return constants_.view.walls->may_be_met(disk.position, disk.position + constants_.duration * disk.velocity);
  }

  [[nodiscard]] Around around_of(Block const& home) const {
    Block const* const below = &grid_.block_at(home.column, grid_.row_below(home.row));
    Block const* const here = &grid_.block_at(home.column, home.row);
    Block const* const above = &grid_.block_at(home.column, grid_.row_above(home.row));
    int const left = grid_.column_left_of(home.column) - home.column;
    constexpr int middle = 0;
    int const right = grid_.column_right_of(home.column) - home.column;
    return {below + left, below + middle, below + right, here + left,  here + right,
            above + left, above + middle, above + right, here + middle};
  }

  static bool has_further_blocks(Around const& around) {
    std::uint32_t next = PackedGrid::none;
    for (Block const* const block : around) next &= block->next;
    return next != PackedGrid::none;
  }

  [[nodiscard]] std::uint64_t find_near(std::size_t i, Block const& home, std::uint32_t slot,
                                        Around const& around) const {
    Vector const v = constants_.view.disks[i].velocity;
    double const contact = constants_.cutoff.contact(constants_.view.disks[i].radius);
    double const squared_cutoff = contact * contact + constants_.duration * constants_.duration * squared_length(v);
    auto const limit = static_cast<float>(squared_cutoff * constants_.limit_per_area) + constants_.limit_error;
    PackedGrid::LocalPoint const p =
        grid_.local(constants_.view.disks[i].position + constants_.duration * v, home.column, home.row);
    float const left = p.x + grid_.local_width();
    float const right = p.x - grid_.local_width();
    float const below = p.y + grid_.local_height();
    float const above = p.y - grid_.local_height();
    auto const is_near = [&](std::size_t k, float x, float y) {
      return PackedGrid::is_near(*around[k], {x, y}, limit);
    };
    std::uint64_t const first =
        bits_of(is_near(0, left, below), is_near(1, p.x, below), is_near(2, right, below), is_near(3, left, p.y));
    std::uint64_t const last =
        bits_of(is_near(4, right, p.y), is_near(5, left, above), is_near(6, p.x, above), is_near(7, right, above));
    std::uint64_t const own_cell = bits_of(is_near(own, p.x, p.y)) & ~(1U << slot);
    return first | last << (slots * 4) | own_cell << (slots * own);
  }

  template <EdgeOfTurn edge>
  void take_among(Prepared const& turn, Counters& counters) {
    if (turn.near == 0) {
      take_turn<edge>(constants_.view, turn.disk, counters, [](Partner&) {});
      return;
    }
    Around const around = around_of(std::as_const(grid_).block_of(turn.disk));
    std::array<std::uint32_t, 9 * slots> candidates;
    std::size_t count = 0;
    for (std::uint64_t left = turn.near; left != 0; left &= left - 1) {
      auto const bit = static_cast<std::size_t>(std::countr_zero(left));
      candidates[count++] = around[bit / slots]->agent[bit % slots];
    }
    take_turn<edge>(constants_.view, turn.disk, counters, [&](Partner& partner) {
      for (std::size_t n = 0; n < count; ++n) partner.consider(candidates[n]);
    });
  }

  TurnConstants constants_;
  PackedGrid& grid_;
};

}  // namespace gridlock
