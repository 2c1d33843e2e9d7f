#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/workspace/run_directory.hpp"

namespace gridlock {

/// The settings of a run as its directory keeps them.
inline constexpr char const* configuration_name = "config.resolved.toml";

/// Errors: Error where a directory holds no run.
void require_run(std::filesystem::path const& directory);

/// The settings of the run in a directory, with another length where one is asked for; a length that the run has
/// already is none. Errors: Error where the run cannot be continued.
SettingsFile settings_to_continue(std::filesystem::path const& directory, std::optional<RunLength>& length);

/// "300 steps or time 2.5"
std::string length_text(RunLength const& length);

}  // namespace gridlock
