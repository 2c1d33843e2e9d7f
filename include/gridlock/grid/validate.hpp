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

/// The largest overlaps that validate() accepts as rounding; by default none.
struct Tolerance {
  double overlap = 0.0;       ///< overlap of two disks
  double beyond_walls = 0.0;  ///< length by which a disk extends beyond a wall
};

/// Throws Error with every broken invariant (the first few of each kind): finite columns, positive radius and mass,
/// centres at least a radius inside walls or within [0, side) of a periodic box, a periodic box that holds the largest
/// disk without overlap with its own image, and no two disks nearer than the sum of their radii (with both Ids and the
/// gap). Sides, radii, masses and the largest speed must be from 10⁻⁶⁰ to 10⁶⁰ (a speed may be 0), so that no product
/// of them overflows.
/// Cost: O(N) for disks of similar size.
void validate(State const& state, Tolerance const& tolerance = {});

/// Returns the largest overlap that rounding explains: 10⁻¹² diameters of the smallest disk or, in large boxes, a few
/// last digits of the coordinates. Disks saved at the exact time of their contact can overlap by this much.
double rounding_of_contact(State const& state);

/// Returns the largest overlap max(0, R_i + R_j − |r_j − r_i|) of all pairs; 0 if no disks overlap.
double largest_overlap(State const& state);

}  // namespace gridlock
