#pragma once

#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

// The kernels of find_neighbours(), which a test compares.

std::size_t find_neighbours_scalar(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found);

bool can_find_neighbours_with_avx512();
/// Contract: can_find_neighbours_with_avx512().
std::size_t find_neighbours_avx512(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found);

}  // namespace gridlock
