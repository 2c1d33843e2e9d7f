#pragma once

/// \file
/// Checks that disks neither overlap nor leave the box.
///
/// ```cpp
/// State state{.box = Box(1.0, 1.0, Edge::wall)};
/// state.agents.add(0.5, 0.5, 0.0, 0.0, 0.1, 1.0, 0, 0);
/// validate(state);
/// double const overlap = largest_overlap(state);  // 0
/// ```

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Overlaps that validate() lets pass as rounding; by default none.
struct Tolerance {
  double overlap = 0.0;       ///< of two disks
  double beyond_walls = 0.0;  ///< of a rim
};

/// Throws Error naming every broken invariant (the first few of each kind): finite columns, positive radius and mass,
/// centres at least a radius inside the walls or within [0, side) of a periodic box whose sides hold the largest disk
/// (or a disk would overlap its own image), and no two disks nearer than the sum of their radii; an overlap names both
/// Ids and the gap. Sides, radii, masses and the largest speed lie from 10⁻⁶⁰ to 10⁶⁰, or nothing moves at all, so that
/// no product of them leaves the range of numbers.
/// Cost: O(N) for disks of similar size.
void validate(State const& state, Tolerance const& tolerance = {});

/// The overlap that is only rounding: 10⁻¹² diameters of the smallest disk or, in large boxes, a few last digits of the
/// coordinates. Disks written at the exact time at which they touch have it.
double rounding_of_contact(State const& state);

/// The largest shortfall max(0, R_i + R_j − |r_j − r_i|) over all pairs; 0 where no disks overlap.
double largest_overlap(State const& state);

}  // namespace gridlock
