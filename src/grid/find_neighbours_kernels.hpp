#pragma once

#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

using FindNeighbours = std::size_t (*)(RowSearch const&, std::span<RowRange const>, std::uint32_t*);

/// Returns the kernel of find_neighbours() for these instructions, or for the next simpler ones that have a kernel. All
/// find the same rows in the same order, as a test verifies. Contract: is_available(target).
FindNeighbours find_neighbours_kernel(Target target);

std::size_t find_neighbours_scalar(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found);

// Kernels of one file each; nullptr where the file has none for these instructions.

FindNeighbours find_neighbours_with_avx512(Target target);
FindNeighbours find_neighbours_with_highway(Target target);

}  // namespace gridlock
