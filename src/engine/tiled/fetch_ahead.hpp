#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "engine/turn.hpp"
#include "gridlock/core/look_ahead.hpp"
#include "gridlock/grid/packed_grid.hpp"
#include "gridlock/grid/tiling.hpp"

namespace gridlock {

/// Asks for the memory of tiles to come, a little with each turn taken, so that memory is busy while the processor
/// computes: a line from memory takes as long as three turns, but many may be on their way at once.
///
///     tile      now │ next │ after next
///     asked for     │ its disks, by the blocks that have come │ its blocks
///
/// Only blocks of the next tile and its ring are read, which no other thread touches in this round.
class FetchAhead {
 public:
  FetchAhead(PackedGrid const& grid, TurnView const& view)
      : grid_(grid), disks_(view.disks.data()), is_worth_it_(view.disks.size() > few_disks) {}

  /// The tiles that follow, nullptr where there is none; step() will be called about `steps` times before they are due.
  void aim(Tiling::Tile const* next, Tiling::Tile const* after_next, std::size_t steps) {
    if (!is_worth_it_) return;
    disk_walk_ = walk_of(next);
    block_walk_ = walk_of(after_next);
    cells_a_step_ = std::max(disk_walk_.cells(), block_walk_.cells()) / (steps + 1) + 1;
  }

  void step() {
    for (std::size_t n = 0; n < cells_a_step_; ++n) {
      if (disk_walk_.is_going_on()) {
        // Empty slots name disks that were here before: asking for one too many costs less than a branch.
        for (std::uint32_t const disk : grid_.block_at(disk_walk_.column, disk_walk_.row).agent)
          prefetch(&disks_[disk]);
        disk_walk_.go_on();
      }
      if (block_walk_.is_going_on()) {
        prefetch(&grid_.block_at(block_walk_.column, block_walk_.row));
        block_walk_.go_on();
      }
    }
  }

 private:
  /// Cell after cell of a tile and its ring.
  struct Walk {
    int first_column = 0, end_column = 0, row = 0, end_row = 0;
    int column = 0;

    [[nodiscard]] bool is_going_on() const { return row < end_row; }
    [[nodiscard]] std::size_t cells() const {
      return static_cast<std::size_t>(end_column - first_column) * static_cast<std::size_t>(end_row - row);
    }
    void go_on() {
      if (++column < end_column) return;
      column = first_column;
      ++row;
    }
  };

  [[nodiscard]] Walk walk_of(Tiling::Tile const* tile) const {
    if (tile == nullptr) return {};
    int const first_column = std::max(0, tile->first_column - 1);
    return {.first_column = first_column,
            .end_column = std::min(grid_.layout().columns(), tile->end_column + 1),
            .row = std::max(0, tile->first_row - 1),
            .end_row = std::min(grid_.layout().rows(), tile->end_row + 1),
            .column = first_column};
  }

  /// That many disks and their blocks stay in the caches from step to step, some 3 MB.
  static constexpr std::size_t few_disks = 25'000;

  PackedGrid const& grid_;
  DiskInTurn const* disks_;
  bool is_worth_it_;
  Walk disk_walk_;
  Walk block_walk_;
  std::size_t cells_a_step_ = 0;
};

}  // namespace gridlock
