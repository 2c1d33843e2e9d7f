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

/// The tiles of each part, with about as many agents in each; `agents` has a number for each tile.
std::vector<Tiling::Rectangle> divide_tiles(Tiling const& tiling, std::span<std::uint64_t const> agents,
                                            std::size_t parts);

/// The cells of a rectangle of tiles and `margin` more to each side, as far as the box has them.
CellWindow window_around(CellLayout const& layout, Tiling const& tiling, Tiling::Rectangle const& rectangle,
                         int margin);
/// The same for one tile.
CellWindow window_around(CellLayout const& layout, Tiling::Tile const& tile, int margin);

/// Whether the windows have a cell in common.
bool overlap(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

/// The cells that two windows have in common.
std::vector<int> common_cells(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

/// The tile of a point. Contract: it does not outlive the cells and tiles that it is made of.
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
