#pragma once

#include <string>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Where the paper's rule, which has a time step, is known to mislead for these disks, as a part of a sentence; empty
/// where it is not. See docs/explanation/paper.md, "Physics, or the time step?" and "In a periodic box".
std::string where_time_steps_mislead(Box const& box, Disks const& disks);

}  // namespace gridlock
