#pragma once

#include "gridlock/core/disks.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// Hard disks, the model of the disk engines.
struct HardDisks {
  using Agents = Disks;
};

/// All of the physics of hard disks and nothing else: two equal states have equal futures under the same engine settings.
using State = World<HardDisks>;

}  // namespace gridlock
