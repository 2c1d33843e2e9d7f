#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"

namespace gridlock::python {

/// Disks that move one after the other, and none into another: the rule of the paper, without velocities.
struct DisksToMove {
  Box const& box;
  std::span<double> x;
  std::span<double> y;
  std::span<double const> radius;
  std::span<std::uint32_t const> order;  ///< the rows in the order of their turns
  std::uint64_t parts = 1;               ///< number of equal parts of each displacement
};

/// The end of the moves, two numbers for each disk.
struct MovesApart {
  std::vector<std::uint8_t> walls;     ///< 1 where a wall along x, or along y, has halted it
  std::vector<std::int64_t> partners;  ///< row of the disk that has halted it; −1 if none
  std::vector<std::int32_t> crossed;   ///< periodic edges crossed along x and along y
};

/// Moves each disk by the vector `by` of its row, in parts. The first part that would bring it nearer than its radius
/// to a wall, or nearer than the sum of their radii to another disk, halts it before this part; its partner is the
/// nearest such disk, of two equally near ones that of the earlier turn. A disk that overlaps a wall or another disk
/// already may move away from it.
/// Cost: that of one step of `stepped` for similar radii. Contract: each displacement is shorter than the box.
MovesApart move_apart(DisksToMove const& disks, std::span<double const> by);

}  // namespace gridlock::python
