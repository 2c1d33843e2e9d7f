#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// What one look at all neighbours of all N disks costs on k × k neighbourhoods, in distances checked.

/// The paper's estimate 9N²/k²: N disks, nine neighbourhoods each, N/k² disks in a neighbourhood.
double paper_checks(std::uint64_t disks, std::uint64_t k);

/// How many neighbourhoods a 3×3 block holds on average: (3k − 2)²/k², since a block at a wall is cut, 3 × 2 and 2 × 2 at
/// the corners. 1 for k = 1, 4 for k = 2, 7.84 for k = 10, towards 9.
double mean_block_size(std::uint64_t k);

/// The same cost exactly, for disks that stand anywhere with equal chance:
///     N (N − 1) (3k − 2)²/k⁴
/// A disk is in each neighbourhood with chance 1/k², each of the other N − 1 is in its block with chance (cells)/k², and
/// no disk checks itself.
double uniform_checks(std::uint64_t disks, std::uint64_t k);

/// The same cost for the disks where they stand now, counted.
/// Cost: O(N + k²).
std::uint64_t checks_of_one_look(State const& state, std::uint64_t k);

}  // namespace gridlock
