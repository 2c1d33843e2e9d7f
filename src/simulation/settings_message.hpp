#pragma once

#include "gridlock/io/settings_file.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// Copies the settings of the root to all processes, which call this together.
/// Errors: RunFailure if a process has other keys, and thus runs another version of the program.
void broadcast_settings(AllProcesses processes, Describe const& describe);

}  // namespace gridlock
