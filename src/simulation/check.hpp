#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Refuses what is wrong with a configuration before anything is made of it: tables of models that are not run,
/// settings with which no run is possible, more memory than there is. Errors: Error.
void check(Configuration const& configuration, IsGiven const& is_given, AllProcesses processes);

/// Refuses a run that so many processes cannot share. Errors: Error.
void require_shareable(Configuration const& configuration, std::size_t processes);

/// Refuses a run that cannot come to its end, and frames that cannot be: of a set-up whose simulation is made.
/// Errors: Error.
void check_end(Setup const& setup);

/// Notes on settings that were given although nothing of the run depends on them; of a configuration before it is
/// resolved, which makes the default of what was left out look like a choice.
std::vector<Event> unused_settings(Configuration const& configuration, IsGiven const& is_given);

/// Notes on frames beyond the end of the run.
std::vector<Event> frames_beyond_end(Setup const& setup);

}  // namespace gridlock
