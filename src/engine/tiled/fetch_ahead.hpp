#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// Prefetches the memory of coming tiles, a little with each group of turns, so that memory works while the processor
/// computes: a cache line takes as long as three turns to arrive, but many can be on their way at once.
///
/// tiles       now │ next │ after next
///     prefetched      │ their disks, found in blocks that have arrived │ their blocks
///
/// It reads only blocks of the next tiles and their rings, which no other thread changes in this round.
class FetchAhead {
 public:
  FetchAhead(PackedGrid const& grid, TurnView const& view, std::vector<std::uint32_t> const& id_indices,
             Tiling const& tiling)
      : grid_(grid),
        tiling_(tiling),
        disks_(view.disks.data()),
        id_indices_(id_indices.data()),
        is_worth_it_(view.disks.size() > few_disks) {}

  /// Sets the tiles that follow. About `turns` turns will be reported to advance() before those tiles are due.
  void aim(std::span<std::uint32_t const> next, std::span<std::uint32_t const> after_next, std::size_t turns) {
    if (!is_worth_it_) return;
    disk_walk_ = {next};
    block_walk_ = {after_next};
    cells_a_turn_ = std::max(cells_of(next), cells_of(after_next)) / (turns + 1) + 1;
  }

  /// Prefetches as much as fits beside `turns` turns.
  void advance(std::size_t turns) {
    advance(disk_walk_, cells_a_turn_ * turns, [this](int column, int row) {
      PackedGrid::Block const& block = grid_.block_at(column, row);
      // Empty slots keep rows of disks that have left: an unneeded prefetch is cheaper than a branch.
      for (std::uint32_t const disk : block.agent) prefetch(&disks_[disk]);
      // One cache line holds sixteen of these, and disks of a cell had adjacent rows when they were sorted.
      grid_.prefetch(block.agent[0]);
      prefetch(&id_indices_[block.agent[0]]);
    });
    advance(block_walk_, cells_a_turn_ * turns,
            [this](int column, int row) { prefetch(&grid_.block_at(column, row)); });
  }

 private:
  /// The cells of a tile and its ring.
  struct Area {
    int first_column = 0, end_column = 0, row = 0, end_row = 0;

    [[nodiscard]] std::size_t cells() const {
      return static_cast<std::size_t>(end_column - first_column) * static_cast<std::size_t>(end_row - row);
    }
  };
  [[nodiscard]] Area area_of(std::uint32_t number) const {
    Tiling::Tile const& tile = tiling_.tiles()[number];
    return {.first_column = std::max(0, tile.first_column - 1),
            .end_column = std::min(grid_.layout().columns(), tile.end_column + 1),
            .row = std::max(0, tile.first_row - 1),
            .end_row = std::min(grid_.layout().rows(), tile.end_row + 1)};
  }
  [[nodiscard]] std::size_t cells_of(std::span<std::uint32_t const> tiles) const {
    std::size_t cells = 0;
    for (std::uint32_t const tile : tiles) cells += area_of(tile).cells();
    return cells;
  }

  /// A walk cell by cell: the rest of `area` first, then the areas of `tiles`.
  struct Walk {
    std::span<std::uint32_t const> tiles;
    Area area{};
    int column = 0;
  };
  template <class Visit>
  void advance(Walk& walk, std::size_t cells, Visit visit) {
    for (auto left = static_cast<int>(cells); left > 0;) {
      if (walk.area.row == walk.area.end_row) {
        if (walk.tiles.empty()) return;
        walk.area = area_of(walk.tiles.front());
        walk.column = walk.area.first_column;
        walk.tiles = walk.tiles.subspan(1);
      }
      int const end = std::min(walk.area.end_column, walk.column + left);
      left -= end - walk.column;
      for (; walk.column < end; ++walk.column) visit(walk.column, walk.area.row);
      if (walk.column == walk.area.end_column) {
        walk.column = walk.area.first_column;
        ++walk.area.row;
      }
    }
  }

  /// Number of disks that stay in the caches from step to step with their blocks, some 3 MB.
  static constexpr std::size_t few_disks = 25'000;

  PackedGrid const& grid_;
  Tiling const& tiling_;
  DiskInTurn const* disks_;
  std::uint32_t const* id_indices_;
  bool is_worth_it_;
  Walk disk_walk_;
  Walk block_walk_;
  std::size_t cells_a_turn_ = 0;
};

}  // namespace gridlock
