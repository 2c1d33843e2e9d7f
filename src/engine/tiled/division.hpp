#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock::tiled {

/// The tiles of each rank, with about as many disks in each; `disks` has a number for each tile.
std::vector<Tiling::Rectangle> divide(Tiling const& tiling, std::span<std::uint64_t const> disks, std::size_t ranks);

/// The cells of a rectangle of tiles and `margin` more to each side, as far as the box has them.
CellWindow window_around(CellLayout const& layout, Tiling const& tiling, Tiling::Rectangle const& rectangle,
                         int margin);

/// Whether the windows have a cell in common.
bool overlap(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

/// The cells that two windows have in common.
std::vector<int> common_cells(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

}  // namespace gridlock::tiled
