#pragma once

#include <cstddef>
#include <numbers>

#include "gridlock/core/disks.hpp"
#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// Returns the largest side of a cell that never holds more than four centres of disks that do not overlap: five
/// centres a diameter apart need a square with sides of √2 diameters.
inline double widest_for_four(double smallest_radius) {
  return 2.0 * std::numbers::sqrt2 * smallest_radius * (1.0 - 1e-6);
}

/// Returns the cells of a packed grid for disks that move at most `displacement` in a step: a 3×3 block contains all
/// disks that one can hit. If possible, a cell is no wider than widest_for_four(), so that equal disks never need a
/// second block.
CellLayout packed_layout(Box const& box, RadiusRange const& radii, std::size_t disks, double displacement);
inline CellLayout packed_layout(Box const& box, Disks const& disks, double displacement) {
  return packed_layout(box, radius_range(disks), disks.size(), displacement);
}

}  // namespace gridlock
