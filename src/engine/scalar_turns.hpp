#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/on_device.hpp"
#include "engine/headings.hpp"
#include "engine/turn.hpp"
#include "gridlock/grid/detail/packed_cells.hpp"

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

  [[nodiscard]] GRIDLOCK_ON_DEVICE double of(double radius, double squared_speed) const {
    return contact(radius) + std::sqrt(squared_speed) * duration_ + rounding_;
  }
  /// The largest contact distance of a disk.
  [[nodiscard]] constexpr double contact(double radius) const { return radius + largest_radius_; }
  [[nodiscard]] constexpr double rounding() const { return rounding_; }

 private:
  double largest_radius_;
  double duration_;
  double rounding_;
};

/// Numbers that do not change from turn to turn.
struct TurnLimits {
  TurnLimits(Box const& box, PackedGeometry const& grid, RadiusRange const& radii, double step_duration,
             std::uint64_t substeps)
      : cutoff(box, radii.largest, step_duration, substeps),
        duration(step_duration),
        room(std::min(grid.layout().cell_width(), grid.layout().cell_height()) * (1.0 - 1e-9)),
        limit_per_area(1.001 * grid.locals_per_length() * grid.locals_per_length()),
        limit_error(grid.local_limit(0.0)),
        inner_columns(static_cast<unsigned>(std::max(0, grid.layout().columns() - 2))),
        inner_rows(static_cast<unsigned>(std::max(0, grid.layout().rows() - 2))) {}

  Cutoff cutoff;
  double duration;
  double room;  ///< distance for contact and displacement within which a turn is local
  double limit_per_area;
  float limit_error;
  unsigned inner_columns;  ///< columns that are not at an edge
  unsigned inner_rows;
};

/// Takes turns one by one on a packed grid. The candidates of a disk are found once for each turn, and only those it
/// may meet.
///
/// During its displacement w, a disk at distance vector −d from another and not in contact, |d| ≥ c, comes as near as c
/// after a part s ≤ 1 of it only if |d − s w|² < c², thus |d|² − c² < 2 s d·w − s² w² ≤ 2 s d·w. The left side is not
/// below 0, so neither is d·w, and the bound holds for s = 1 as well: |d − w|² < c² + w². So one comparison per
/// candidate, relative to the end of the displacement, is enough; in a dense system one candidate in twelve is left.
///
/// `Grid` is PackedGrid or one like it in the memory of a graphics processor; all functions are constexpr for that.
template <class Grid>
class ScalarTurns {
  using Block = PackedBlock;
  using LocalPoint = PackedGeometry::LocalPoint;

 public:
  constexpr ScalarTurns(TurnView const& view, TurnLimits const& limits, Grid& grid)
      : view_(view), limits_(limits), grid_(grid) {}

  /// Returns whether the disk stays in the 3×3 block around its cell during its turn and meets only disks in the block.
  [[nodiscard]] constexpr bool is_local(std::size_t i, double squared_speed) const {
    double const displacement =
        limits_.room - limits_.cutoff.contact(view_.disks[i].radius) - limits_.cutoff.rounding();
    return displacement > 0.0 && squared_speed * limits_.duration * limits_.duration <= displacement * displacement;
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
  [[nodiscard]] constexpr Prepared prepare(std::size_t i) const {
    return prepare(i, grid_.block_of(i), grid_.slot_of(i));
  }
  /// As prepare(i), for a disk known to be in this slot.
  [[nodiscard]] constexpr Prepared prepare(std::size_t i, Block const& home, std::uint32_t slot) const {
    Around const around = around_of(home);
    // One cell is wider than displacement and contact distance, so a disk in an inner cell cannot get to the edge.
    bool const is_far_from_edge = static_cast<unsigned>(home.column - 1) < limits_.inner_columns &&
                                  static_cast<unsigned>(home.row - 1) < limits_.inner_rows && !may_meet_wall(i);
    return {.near = find_near(i, home, slot, around),
            .disk = static_cast<std::uint32_t>(i),
            .is_far_from_edge = is_far_from_edge,
            .needs_more_blocks = grid_.has_further_blocks() && has_further_blocks(around)};
  }

  constexpr void take(Prepared const& turn, Counters& counters) {
    if (turn.needs_more_blocks) {
      take_any(turn.disk, counters);
      return;
    }
    if (turn.is_far_from_edge) {
      take_among<EdgeOfTurn::is_far>(turn, counters);
    } else {
      take_among<EdgeOfTurn::may_be_met>(turn, counters);
    }
    grid_.move(turn.disk, view_.disks[turn.disk].position);
  }

  /// Takes the turn of disk i, however far it moves.
  constexpr void take_any(std::size_t i, Counters& counters) {
    double const distance = limits_.cutoff.of(view_.disks[i].radius, squared_length(view_.disks[i].velocity));
    int const columns = grid_.layout().columns_within(distance);
    int const rows = grid_.layout().rows_within(distance);
    int const cell = grid_.cell_of(i);
    take_turn(view_, i, counters, [&](Partner& partner) {
      grid_.for_each_in_block(cell, columns, rows, [&](std::size_t j) { partner.consider(j); });
    });
    grid_.move(i, view_.disks[i].position);
  }

 private:
  /// The blocks of the cells around a disk's cell, row by row from below left, then of its own cell.
  using Around = std::array<Block const*, 9>;
  static constexpr std::size_t slots = Block::slots;
  static constexpr std::size_t own = 8;

  /// Returns whether the disk may touch a wall inside the box in its turn.
  [[nodiscard]] constexpr bool may_meet_wall(std::size_t i) const {
    if (view_.walls.empty()) return false;
    DiskInTurn const& disk = view_.disks[i];
    return view_.walls.may_be_met(disk.position, disk.position + limits_.duration * disk.velocity);
  }

  [[nodiscard]] constexpr Around around_of(Block const& home) const {
    Block const* const below = &grid_.block_at(home.column, grid_.row_below(home.row));
    Block const* const here = &grid_.block_at(home.column, home.row);
    Block const* const above = &grid_.block_at(home.column, grid_.row_above(home.row));
    int const left = grid_.column_left_of(home.column) - home.column;
    constexpr int middle = 0;
    int const right = grid_.column_right_of(home.column) - home.column;
    return {below + left, below + middle, below + right, here + left,  here + right,
            above + left, above + middle, above + right, here + middle};
  }

  static constexpr bool has_further_blocks(Around const& around) {
    std::uint32_t next = PackedGeometry::none;
    for (Block const* const block : around) next &= block->next;
    return next != PackedGeometry::none;
  }

  [[nodiscard]] constexpr std::uint64_t find_near(std::size_t i, Block const& home, std::uint32_t slot,
                                                  Around const& around) const {
    Vector const v = view_.disks[i].velocity;
    double const contact = limits_.cutoff.contact(view_.disks[i].radius);
    double const squared_cutoff = contact * contact + limits_.duration * limits_.duration * squared_length(v);
    auto const limit = static_cast<float>(squared_cutoff * limits_.limit_per_area) + limits_.limit_error;
    LocalPoint const p = grid_.local(view_.disks[i].position + limits_.duration * v, home.column, home.row);
    float const left = p.x + grid_.local_width();
    float const right = p.x - grid_.local_width();
    float const below = p.y + grid_.local_height();
    float const above = p.y - grid_.local_height();
    auto const near_row = [&](std::size_t k, std::array<LocalPoint, 4> const& points) -> std::uint64_t {
      return Grid::near_bits({around[k], around[k + 1], around[k + 2], around[k + 3]}, points, limit);
    };
    std::uint64_t const first = near_row(0, {{{left, below}, {p.x, below}, {right, below}, {left, p.y}}});
    std::uint64_t const last = near_row(4, {{{right, p.y}, {left, above}, {p.x, above}, {right, above}}});
    std::uint64_t const own_cell = Grid::near_bits(*around[own], p, limit) & ~(1U << slot);
    return first | last << (slots * 4) | own_cell << (slots * own);
  }

  template <EdgeOfTurn edge>
  constexpr void take_among(Prepared const& turn, Counters& counters) {
    if (turn.near == 0) {
      take_turn<edge>(view_, turn.disk, counters, [](Partner&) {});
      return;
    }
    Around const around = around_of(grid_.block_of(turn.disk));
    std::array<std::uint32_t, 9 * slots> candidates{};
    std::size_t count = 0;
    for (std::uint64_t left = turn.near; left != 0; left &= left - 1) {
      auto const bit = static_cast<std::size_t>(std::countr_zero(left));
      candidates[count++] = around[bit / slots]->agent[bit % slots];
    }
    take_turn<edge>(view_, turn.disk, counters, [&](Partner& partner) {
      for (std::size_t n = 0; n < count; ++n) partner.consider(candidates[n]);
    });
  }

  TurnView const& view_;
  TurnLimits limits_;
  Grid& grid_;
};

}  // namespace gridlock
