#pragma once

#include "gridlock/core/disks.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// Hard disks, the model of the disk engines.
struct HardDisks {
  using Agents = Disks;
};

/// All of the physics of hard disks and nothing else: two equal states have equal futures under the same engine settings.
///
/// ```cpp
/// State state{.box = Box(1.0, 1.0, Edge::wall), .seed = 7};
/// state.agents.add(0.5, 0.5, 1.0, 0.0, 0.1, 1.0, 0, 0);  // x, y, vx, vy, radius, mass, images
/// std::uint64_t const identity = hash(state);
/// ```
using State = World<HardDisks>;

}  // namespace gridlock
