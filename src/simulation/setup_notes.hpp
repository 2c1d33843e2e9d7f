#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// Notes on settings that were given although nothing of the run depends on them; of a configuration before it is resolved,
/// which makes the default of what was left out look like a choice.
std::vector<SetupNote> unused_settings(Configuration const& configuration,
                                       std::function<bool(std::string_view)> const& is_given);

/// All other notes on a set-up that is complete.
std::vector<SetupNote> notes_of(Setup const& setup);

}  // namespace gridlock
