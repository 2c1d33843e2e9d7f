#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/vector.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// Divides the tiles into rectangles, one for each part, with about equal numbers of agents; `agents` has the number
/// for each tile.
std::vector<Tiling::Rectangle> divide_tiles(Tiling const& tiling, std::span<std::uint64_t const> agents,
                                            std::size_t parts);

/// Returns the cells of a rectangle of tiles and `margin` more to each side, without those beyond walls.
CellWindow window_around(CellLayout const& layout, Tiling const& tiling, Tiling::Rectangle const& rectangle,
                         int margin);
/// Returns the cells of one tile and `margin` more to each side, without those beyond walls.
CellWindow window_around(CellLayout const& layout, Tiling::Tile const& tile, int margin);

/// Returns whether two windows have a cell in common.
bool overlap(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

std::vector<int> common_cells(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

/// Finds the tile of a point. Contract: `layout` and `tiling` outlive it.
class TileFinder {
 public:
  TileFinder(CellLayout const& layout, Tiling const& tiling);

  [[nodiscard]] std::uint32_t tile_of(Vector p) const {
    return tiling_.number_of(column_of_[static_cast<std::size_t>(layout_.column_of(p.x))],
                             row_of_[static_cast<std::size_t>(layout_.row_of(p.y))]);
  }

 private:
  CellLayout const& layout_;
  Tiling const& tiling_;
  std::vector<std::size_t> column_of_;
  std::vector<std::size_t> row_of_;
};

}  // namespace gridlock
