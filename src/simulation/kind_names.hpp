#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gridlock/io/settings_file.hpp"

namespace gridlock {

/// What the model of a configuration calls the numbers 0, 1, 2 … of a column; empty for disks, for numbers without names
/// and for a model that this program does not know.
std::vector<std::string> kind_names(SettingsFile const& file, std::string_view column);

}  // namespace gridlock
