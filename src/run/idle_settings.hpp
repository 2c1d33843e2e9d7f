#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "gridlock/run/configuration.hpp"

namespace gridlock {

/// The settings given that nothing of the run depends on.
std::vector<IdleSetting> idle_settings(Configuration const& configuration,
                                       std::function<bool(std::string_view)> const& is_given);

}  // namespace gridlock
