#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/setup.hpp"

namespace gridlock {

/// Checks a configuration before anything is created from it. Errors: Error for tables of other models, settings with
/// which no run is possible, or too little free memory.
void check(Configuration const& configuration, IsGiven const& is_given, AllProcesses processes);

/// Throws an Error if `processes` processes cannot share the run.
void require_shareable(Configuration const& configuration, std::size_t processes);

/// Checks the end of a run whose simulation exists. Errors: Error if the end cannot be reached, or frames at steps or
/// times that do not occur are requested.
void check_end(Setup const& setup);

/// Returns notes on given settings without effect on the run. Resolving a configuration fills in defaults, which would
/// look like given settings, so call it before.
std::vector<Event> unused_settings(Configuration const& configuration, IsGiven const& is_given);

/// Returns notes on requested frames after the end of the run.
std::vector<Event> frames_beyond_end(Setup const& setup);

}  // namespace gridlock
