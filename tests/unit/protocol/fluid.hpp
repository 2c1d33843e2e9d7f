#pragma once

#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// Few disks of two sizes in a fluid.
inline State fluid(Edge edge = Edge::periodic) {
  DisksSettings disks{.count = 36, .packing_fraction = 0.4, .start = StartKind::random};
  disks.species = {{.fraction = 0.5, .size_ratio = 1.0}, {.fraction = 0.5, .size_ratio = 1.4}};
  State state = make_start(Box(1.1, 0.9, edge), disks, 3);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

}  // namespace gridlock
