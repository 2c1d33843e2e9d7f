#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock::tiled {

/// The tiles of each rank: strips of rows of tiles, each cut into rectangles, with about as many disks in each. Ranks
/// beyond the number of tiles have none.
///
///     ┌────┬──┬───┐
///     │ 3  │4 │ 5 │    `disks` has a number for each tile
///     ├──┬─┴──┼───┤
///     │0 │ 1  │ 2 │
///     └──┴────┴───┘
std::vector<Tiling::Rectangle> divide(Tiling const& tiling, std::span<std::uint64_t const> disks, std::size_t ranks);

/// The part of a window that a walled box has, or all columns or rows of a periodic one where it has as many.
CellWindow within(CellLayout const& layout, CellWindow window);

/// The cells of a rectangle of tiles and `margin` more to each side, as far as the box has them.
CellWindow window_around(CellLayout const& layout, Tiling const& tiling, Tiling::Rectangle const& rectangle,
                         int margin);

/// Whether the windows have a cell in common.
bool overlap(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

/// The cells that two windows have in common.
std::vector<int> common_cells(CellLayout const& layout, CellWindow const& one, CellWindow const& other);

}  // namespace gridlock::tiled
