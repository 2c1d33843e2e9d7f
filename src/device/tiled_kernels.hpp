#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "device/backend.hpp"
#include "device/cells.hpp"
#include "engine/headings.hpp"
#include "engine/scalar_turns.hpp"
#include "engine/stepped.hpp"
#include "engine/tiled/steps.hpp"
#include "engine/turn.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/grid/detail/class_order.hpp"
#include "gridlock/grid/detail/tiling.hpp"

/// \file
/// A step of `tiled` as kernels. Turns of one class of cells, in all tiles of a colour, touch no common cell: each cell
/// is a thread, and a step is 36 launches. Counts are whole numbers, which may be added in any order. The sums of
/// floating-point numbers of a tile are taken at the end of the step in the order of the turns, for which each disk
/// keeps its terms, and each cell a list of the disks that took their turns in it.

namespace gridlock::device {

/// The counts of the turns of a cell in a step. Distances and sub-steps may be more than 2³²: a cell that holds a large
/// disk may hold thousands of small ones.
struct CellCounts {
  std::uint32_t moves;
  std::uint32_t halted_moves;
  std::uint32_t pair_collisions;
  std::uint64_t distance_checks;
  std::uint64_t swum;
};

/// The counts of a step.
struct StepCounts {
  std::uint64_t moves;
  std::uint64_t halted_moves;
  std::uint64_t pair_collisions;
  std::uint64_t distance_checks;
  std::uint64_t swum;
  std::array<std::uint64_t, 4> wall_hits;
  std::uint64_t inner_wall_hits;
  std::uint32_t tiles_with_late;  ///< tiles with disks too fast for their tile
  std::uint32_t too_fast;         ///< the first disk that could jump over another, or no_disk
  double displacement;            ///< its displacement in a sub-step
};

/// The terms that the turn of a disk adds to sums.
struct TurnTerms {
  double pair_virial;
  double inner_wall_impulse;
  Vector wall_impulse;  ///< on the walls of x and of y; negative on the left one and the lower one
};

/// The sums of the tiles, kind by kind, in one array. Without walls there is the first kind alone.
struct SumOfTile {
  static constexpr std::size_t pair_virial = 0;
  static constexpr std::size_t inner_wall_impulse = 1;
  static constexpr std::size_t wall_impulse = 2;  ///< and the other three walls behind it
  static constexpr std::size_t kinds = wall_impulse + 4;
};

constexpr std::uint32_t no_disk = 0x7fff'ffffU;
constexpr std::uint32_t is_late = 0x8000'0000U;  ///< a bit of the lists of turns

/// Pointers into the memory of the device, and the numbers of TurnRule, for all kernels of a step.
struct TiledMemory {
  Box box;
  double substep;
  std::uint64_t substeps;
  CollisionRule contact;
  bool is_propelled;
  bool has_walls;  ///< at an edge or inside the box
  HeadingStep heading;
  ObstaclesView walls;
  TurnLimits limits;
  double smallest_radius;
  Cells cells;
  std::span<DiskInTurn> disks;
  std::span<Tiling::Tile const> tiles;
  TurnTerms* terms;           ///< of each disk
  std::uint32_t* last_step;   ///< for each disk a number of the step in which it took its last turn
  std::uint32_t* next_turn;   ///< for each disk the one whose turn came next in the same cell; is_late
  std::uint32_t* first_turn;  ///< for each cell the disk whose turn came first in it
  CellCounts* counts_of_cell;
  std::uint32_t* next_late;   ///< for each disk too fast for its tile the next one of the tile
  std::uint32_t* first_late;  ///< for each tile
  std::uint32_t* tiles_with_late;
  double* sums;  ///< see SumOfTile
  StepCounts* counts;

  [[nodiscard]] constexpr TurnView view() const {
    return {.box = box,
            .disks = disks,
            .substep = substep,
            .substeps = substeps,
            .contact = contact,
            .heading = is_propelled ? &heading : nullptr,
            .walls = walls};
  }
  [[nodiscard]] constexpr std::size_t kinds_of_sums() const { return has_walls ? SumOfTile::kinds : 1; }
  [[nodiscard]] constexpr double& sum_of(std::size_t tile, std::size_t kind) const {
    return sums[kind * tiles.size() + tile];
  }
};

/// Takes turns in cells.
class CellTurns {
 public:
  GRIDLOCK_ON_DEVICE CellTurns(TiledMemory const& memory, std::uint32_t step)
      : memory_(memory), step_(step), view_(memory.view()), turns_(view_, memory.limits, memory.cells) {}

  GRIDLOCK_ON_DEVICE void begin(int cell) {
    memory_.first_turn[cell] = no_disk;
    memory_.counts_of_cell[cell] = {};
  }

  /// Takes the turn of the disk with the lowest Id that waits in a cell. Returns false if none waits.
  GRIDLOCK_ON_DEVICE bool take_next(int cell) {
    std::uint32_t const row = first_waiting(cell);
    if (row == no_disk) return false;
    memory_.last_step[row] = step_;
    DiskInTurn& disk = view_.disks[row];
    if (view_.is_propelled()) disk.velocity = turned_velocity(*view_.heading, disk.id_index, disk.velocity);
    bool const is_local = turns_.is_local(row, squared_length(disk.velocity));
    append(cell, row, is_local);
    if (!is_local) return true;
    Counters counters;
    turns_.take(turns_.prepare(row), counters);
    CellCounts& counts = memory_.counts_of_cell[cell];
    counts.moves += static_cast<std::uint32_t>(counters.moves);
    counts.halted_moves += static_cast<std::uint32_t>(counters.halted_moves);
    counts.pair_collisions += static_cast<std::uint32_t>(counters.pair_collisions);
    counts.distance_checks += counters.distance_checks;
    counts.swum += static_cast<std::uint64_t>(counters.swum);
    if (memory_.has_walls) count_walls(counters);
    memory_.terms[row] = terms_of(counters);
    return true;
  }

  /// Takes the turn of a disk too fast for its tile, and adds its terms to the sums of the tile.
  GRIDLOCK_ON_DEVICE void take_late(std::size_t tile, std::uint32_t row) {
    DiskInTurn const& disk = view_.disks[row];
    double const squared_speed = squared_length(disk.velocity);
    StepCounts& counts = *memory_.counts;
    // As Steps::is_short_at().
    if (!is_short(squared_speed * view_.substep * view_.substep, disk.radius + memory_.smallest_radius)) {
      if (counts.too_fast != no_disk) return;
      counts.too_fast = row;
      counts.displacement = std::sqrt(squared_speed) * view_.substep;
      return;
    }
    Counters counters;
    turns_.take_any(row, counters);
    counts.moves += counters.moves;
    counts.halted_moves += counters.halted_moves;
    counts.pair_collisions += counters.pair_collisions;
    counts.distance_checks += counters.distance_checks;
    counts.swum += static_cast<std::uint64_t>(counters.swum);
    count_walls(counters);
    add_terms(memory_, tile, terms_of(counters));
  }

  GRIDLOCK_ON_DEVICE static void add_terms(TiledMemory const& memory, std::size_t tile, TurnTerms const& terms) {
    memory.sum_of(tile, SumOfTile::pair_virial) += terms.pair_virial;
    if (!memory.has_walls) return;
    memory.sum_of(tile, SumOfTile::inner_wall_impulse) += terms.inner_wall_impulse;
    auto const add_signed = [&](double impulse, Counters::Wall lower, Counters::Wall upper) {
      if (impulse < 0.0) memory.sum_of(tile, SumOfTile::wall_impulse + lower) -= impulse;
      if (impulse > 0.0) memory.sum_of(tile, SumOfTile::wall_impulse + upper) += impulse;
    };
    add_signed(terms.wall_impulse.x, Counters::left, Counters::right);
    add_signed(terms.wall_impulse.y, Counters::bottom, Counters::top);
  }

 private:
  [[nodiscard]] GRIDLOCK_ON_DEVICE std::uint32_t first_waiting(int cell) const {
    std::uint32_t found = no_disk;
    std::uint32_t lowest = 0;
    memory_.cells.for_each_in_cell(cell, [&](std::size_t row) {
      if (memory_.last_step[row] == step_) return;
      std::uint32_t const id = view_.disks[row].id_index;
      if (found != no_disk && id > lowest) return;
      found = static_cast<std::uint32_t>(row);
      lowest = id;
    });
    return found;
  }

  GRIDLOCK_ON_DEVICE void append(int cell, std::uint32_t row, bool is_local) {
    memory_.next_turn[row] = no_disk | (is_local ? 0U : is_late);
    std::uint32_t* end = &memory_.first_turn[cell];
    while ((*end & ~is_late) != no_disk) end = &memory_.next_turn[*end & ~is_late];
    *end = (*end & is_late) | row;
  }

  GRIDLOCK_ON_DEVICE void count_walls(Counters const& counters) {
    for (std::size_t wall = 0; wall < 4; ++wall) {
      if (counters.wall_hits[wall] > 0) add(memory_.counts->wall_hits[wall], counters.wall_hits[wall]);
    }
    if (counters.inner_wall_hits > 0) add(memory_.counts->inner_wall_hits, counters.inner_wall_hits);
  }

  /// A disk meets at most one wall of x and one of y in a turn.
  [[nodiscard]] static constexpr TurnTerms terms_of(Counters const& counters) {
    auto const signed_impulse = [&](Counters::Wall lower, Counters::Wall upper) {
      return counters.wall_hits[lower] > 0 ? -counters.wall_impulse[lower] : counters.wall_impulse[upper];
    };
    return {counters.pair_virial,
            counters.inner_wall_impulse,
            {signed_impulse(Counters::left, Counters::right), signed_impulse(Counters::bottom, Counters::top)}};
  }

  TiledMemory const& memory_;
  std::uint32_t step_;
  TurnView view_;
  ScalarTurns<Cells const> turns_;
};

/// The cells of a class in a tile.
struct CellsOfClass {
  Tiling::Tile tile;
  int first_column, first_row;
  int columns, rows;

  constexpr CellsOfClass(Tiling::Tile const& of_tile, std::size_t of_class)
      : tile(of_tile),
        first_column(tile.first_column + static_cast<int>(of_class % 3)),
        first_row(tile.first_row + static_cast<int>(of_class / 3)),
        columns(third(tile.end_column - first_column)),
        rows(third(tile.end_row - first_row)) {}

  [[nodiscard]] constexpr int size() const { return columns * rows; }
  [[nodiscard]] constexpr int cell(int k, CellLayout const& layout) const {
    return (first_row + 3 * (k / columns)) * layout.columns() + first_column + 3 * (k % columns);
  }

 private:
  static constexpr int third(int cells) { return cells > 0 ? (cells + 2) / 3 : 0; }
};

/// Turns of one class of cells in the tiles of a colour, a thread for each cell.
struct TakeTurnsOfCells {
  TiledMemory memory;
  std::uint32_t step;
  std::size_t first_tile;
  std::size_t of_class;
  std::size_t max_cells;  ///< largest number of cells of a class in a tile

  GRIDLOCK_ON_DEVICE void operator()(std::size_t k) const {
    CellsOfClass const cells(memory.tiles[first_tile + k / max_cells], of_class);
    auto const n = static_cast<int>(k % max_cells);
    if (n >= cells.size()) return;
    int const cell = cells.cell(n, memory.cells.layout());
    CellTurns turns(memory, step);
    turns.begin(cell);
    while (turns.take_next(cell)) {
    }
  }
};

/// The same, a thread for each tile, where a tile is its own neighbour around a periodic box: cells three apart may
/// share a neighbour, so that turns come level by level as in ClassOrder.
struct TakeTurnsOfTiles {
  TiledMemory memory;
  std::uint32_t step;
  std::size_t first_tile;
  std::size_t of_class;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t k) const {
    CellsOfClass const cells(memory.tiles[first_tile + k], of_class);
    CellTurns turns(memory, step);
    CellLayout const& layout = memory.cells.layout();
    for (int n = 0; n < cells.size(); ++n) turns.begin(cells.cell(n, layout));
    for (bool is_any_left = true; is_any_left;) {
      is_any_left = false;
      for (int n = 0; n < cells.size(); ++n) is_any_left = turns.take_next(cells.cell(n, layout)) || is_any_left;
    }
  }
};

/// Adds up the turns of a step, a thread for each tile, and lists the disks that are too fast for their tile.
struct AddUpTile {
  TiledMemory memory;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t tile) const {
    for (std::size_t kind = 0; kind < memory.kinds_of_sums(); ++kind) memory.sum_of(tile, kind) = 0.0;
    StepCounts sum{};
    std::uint32_t* end_of_late = &memory.first_late[tile];
    *end_of_late = no_disk;
    for (std::size_t of_class = 0; of_class < ClassOrder::classes; ++of_class) {
      CellsOfClass const cells(memory.tiles[tile], of_class);
      for (int n = 0; n < cells.size(); ++n) {
        CellCounts const& counts = memory.counts_of_cell[cells.cell(n, memory.cells.layout())];
        sum.moves += counts.moves;
        sum.halted_moves += counts.halted_moves;
        sum.pair_collisions += counts.pair_collisions;
        sum.distance_checks += counts.distance_checks;
        sum.swum += counts.swum;
      }
      while (add_level(tile, cells, end_of_late)) {
      }
    }
    StepCounts& counts = *memory.counts;
    add(counts.moves, sum.moves);
    add(counts.halted_moves, sum.halted_moves);
    add(counts.pair_collisions, sum.pair_collisions);
    add(counts.distance_checks, sum.distance_checks);
    add(counts.swum, sum.swum);
    if (memory.first_late[tile] != no_disk) {
      memory.tiles_with_late[fetch_add(counts.tiles_with_late, 1)] = static_cast<std::uint32_t>(tile);
    }
  }

 private:
  /// Takes the first turn out of the list of each cell. Returns false if there was none.
  GRIDLOCK_ON_DEVICE bool add_level(std::size_t tile, CellsOfClass const& cells, std::uint32_t*& end_of_late) const {
    bool is_any = false;
    for (int n = 0; n < cells.size(); ++n) {
      std::uint32_t& first = memory.first_turn[cells.cell(n, memory.cells.layout())];
      std::uint32_t const row = first;
      if (row == no_disk) continue;
      is_any = true;
      std::uint32_t const next = memory.next_turn[row];
      first = next & ~is_late;
      if ((next & is_late) == 0) {
        CellTurns::add_terms(memory, tile, memory.terms[row]);
        continue;
      }
      *end_of_late = row;
      end_of_late = &memory.next_late[row];
      *end_of_late = no_disk;
    }
    return is_any;
  }
};

/// Takes the turns of the disks too fast for their tile, one after the other in the order of tiles, by one thread.
struct TakeLateTurns {
  TiledMemory memory;
  std::uint32_t step;

  GRIDLOCK_ON_DEVICE void operator()(std::size_t /*k*/) const {
    CellTurns turns(memory, step);
    for (std::uint32_t n = 0; n < memory.counts->tiles_with_late; ++n) {
      std::uint32_t const tile = memory.tiles_with_late[n];
      for (std::uint32_t row = memory.first_late[tile]; row != no_disk; row = memory.next_late[row]) {
        turns.take_late(tile, row);
      }
    }
  }
};

}  // namespace gridlock::device
