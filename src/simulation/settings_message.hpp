#pragma once

#include "gridlock/io/settings_file.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// The settings become those of the root, in all processes, which call it together.
/// Errors: RunFailure where a process has other settings to give values to: then it is another program.
void broadcast_settings(AllProcesses processes, Describe const& describe);

}  // namespace gridlock
