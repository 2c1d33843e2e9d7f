#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/workspace/run_directory.hpp"

namespace gridlock {

/// Name of the file with the resolved configuration of a run.
inline constexpr char const* configuration_name = "config.resolved.toml";

/// Errors: Error if the directory contains no run.
void require_run(std::filesystem::path const& directory);

/// Returns the settings of the run in a directory, with `length` if that is given. Resets `length` if an unfinished run
/// already has it. Errors: Error if the run cannot be continued.
SettingsFile settings_to_continue(std::filesystem::path const& directory, std::optional<RunLength>& length);

/// Returns a length as text: "300 steps or time 2.5".
std::string length_text(RunLength const& length);

}  // namespace gridlock
