#pragma once

#include "gridlock/run/configuration.hpp"

namespace gridlock {

/// Refuses a run that needs more memory than the machine has free, before any of it is asked for: a system short of
/// memory kills the program, which leaves no message and no results.
///
/// Counts what can become large: the disks, the cells of the grid, the rows of the series. An estimate, on the low side.
void require_memory(Configuration const& configuration);

}  // namespace gridlock
