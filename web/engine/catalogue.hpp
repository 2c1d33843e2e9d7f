#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock::web {

using Json = nlohmann::ordered_json;

/// Returns all settings, as SettingDescription of gridlock.ts.
Json describe_settings();

/// Returns name and documentation of all models and engines.
Json describe_models();
Json describe_engines();

/// Returns the values of all settings by dotted key; null for settings without a value.
Json values_of(Configuration& configuration);

/// Returns the settings of a TOML text with `overrides` of the form "key=value" on top.
SettingsFile settings_of(std::string const& toml, std::vector<std::string> const& overrides);

/// Returns the settings that a file sets, as TOML with a line for each. Errors: Error if settings are invalid.
std::string given_settings(SettingsFile const& file);

}  // namespace gridlock::web
