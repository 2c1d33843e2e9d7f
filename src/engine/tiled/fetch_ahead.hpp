#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// Asks for the memory of tiles to come, a little with each group of turns taken, so that memory is busy while the
/// processor computes: a line from memory takes as long as three turns, but many may be requested at once.
///
///     tile      now │ next │ after next
///     asked for     │ its disks, by the blocks that have come │ its blocks
///
/// Only blocks of the next tile and its ring are read, which no other thread touches in this round.
class FetchAhead {
 public:
  FetchAhead(PackedGrid const& grid, TurnView const& view, std::vector<std::uint32_t> const& id_indices)
      : grid_(grid),
        disks_(view.disks.data()),
        id_indices_(id_indices.data()),
        is_worth_it_(view.disks.size() > few_disks) {}

  /// The tiles that follow, nullptr where there is none; advance() will be told of about `turns` turns before they are due.
  void aim(Tiling::Tile const* next, Tiling::Tile const* after_next, std::size_t turns) {
    if (!is_worth_it_) return;
    disk_walk_ = walk_of(next);
    block_walk_ = walk_of(after_next);
    cells_a_turn_ = std::max(disk_walk_.cells(), block_walk_.cells()) / (turns + 1) + 1;
  }

  /// While so many turns are taken.
  void advance(std::size_t turns) {
    disk_walk_.advance(cells_a_turn_ * turns, [this](int column, int row) {
      PackedGrid::Block const& block = grid_.block_at(column, row);
      // Empty slots name disks that were here before: asking for one too many costs less than a branch.
      for (std::uint32_t const disk : block.agent) prefetch(&disks_[disk]);
      // Sixteen to a line, and neighbours were side by side when the disks were sorted.
      grid_.prefetch(block.agent[0]);
      prefetch(&id_indices_[block.agent[0]]);
    });
    block_walk_.advance(cells_a_turn_ * turns, [this](int column, int row) { prefetch(&grid_.block_at(column, row)); });
  }

 private:
  /// Cell after cell of a tile and its ring.
  struct Walk {
    int first_column = 0, end_column = 0, row = 0, end_row = 0;
    int column = 0;

    [[nodiscard]] std::size_t cells() const {
      return static_cast<std::size_t>(end_column - first_column) * static_cast<std::size_t>(end_row - row);
    }

    template <class Visit>
    void advance(std::size_t cells, Visit visit) {
      auto left = static_cast<int>(cells);
      while (left > 0 && row < end_row) {
        int const end = std::min(end_column, column + left);
        left -= end - column;
        for (; column < end; ++column) visit(column, row);
        if (column == end_column) {
          column = first_column;
          ++row;
        }
      }
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
  std::uint32_t const* id_indices_;
  bool is_worth_it_;
  Walk disk_walk_;
  Walk block_walk_;
  std::size_t cells_a_turn_ = 0;
};

}  // namespace gridlock
