#pragma once

#include "gridlock/core/state.hpp"

namespace gridlock {

/// Throws Error naming every broken invariant (the first few of each kind): finite columns, positive radius and mass,
/// centres at least a radius inside the walls or within [0, side) of a periodic box whose
/// sides hold the largest disk (or a disk would overlap its own image), and no two disks nearer than the
/// sum of their radii; an overlap names both Ids and the gap.
/// Cost: O(N) for disks of similar size.
void validate(State const& state);

/// The largest shortfall max(0, R_i + R_j − |r_j − r_i|) over all pairs; 0 where no disks overlap.
double largest_overlap(State const& state);

}  // namespace gridlock
