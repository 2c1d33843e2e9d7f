#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "gridlock/grid/detail/tiling.hpp"

namespace gridlock {

/// Returns the weight of each column, summed over rows first_row … end_row − 1.
using WeightsOfColumns = std::function<std::vector<std::uint64_t>(std::size_t first_row, std::size_t end_row)>;

/// Divides columns and rows of tiles or cells into one rectangle for each part: strips of rows, each cut into
/// rectangles of about equal weight. `shape` is height over width. Parts beyond the number of tiles get no rectangle.
///
///     ┌────┬──┬───┐
///     │ 3  │4 │ 5 │
///     ├──┬─┴──┼───┤
///     │0 │ 1  │ 2 │
///     └──┴────┴───┘
std::vector<Tiling::Rectangle> divide(std::span<std::uint64_t const> weights_of_rows, double shape, std::size_t parts,
                                      WeightsOfColumns const& weights_of_columns);

}  // namespace gridlock
