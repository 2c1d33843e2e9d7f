#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// The weight of each column, in rows first_row … end_row − 1.
using WeightsOfColumns = std::function<std::vector<std::uint64_t>(std::size_t first_row, std::size_t end_row)>;

/// Cuts columns and rows of tiles or cells into a rectangle for each part: strips of rows, each cut into rectangles,
/// with about as much weight in each. `shape` is the height over the width. Parts beyond the number of tiles have none.
///
///     ┌────┬──┬───┐
///     │ 3  │4 │ 5 │
///     ├──┬─┴──┼───┤
///     │0 │ 1  │ 2 │
///     └──┴────┴───┘
std::vector<Tiling::Rectangle> divide(std::span<std::uint64_t const> weights_of_rows, double shape, std::size_t parts,
                                      WeightsOfColumns const& weights_of_columns);

}  // namespace gridlock
