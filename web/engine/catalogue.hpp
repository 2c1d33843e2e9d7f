#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock::web {

using Json = nlohmann::ordered_json;

/// Every setting, as the interface SettingDescription of gridlock.ts.
Json describe_settings();

/// The models and the engines: name and documentation.
Json describe_models();
Json describe_engines();

/// The value of every setting by its dotted key; null for one that is left out.
Json values_of(Configuration& configuration);

/// The settings of a TOML text, and "key=value" over them.
SettingsFile settings_of(std::string const& toml, std::vector<std::string> const& overrides);

/// The settings that a file gives, one a line, as TOML. Errors: Error for settings that cannot be read.
std::string given_settings(SettingsFile const& file);

}  // namespace gridlock::web
