#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/io/settings_file.hpp"

namespace gridlock::python {

/// Settings from Python: dotted keys with values in TOML.
using Assignments = std::vector<std::pair<std::string, std::string>>;

/// Reads a TOML file, if given, and sets the assignments on top of it.
inline SettingsFile settings_of(std::optional<std::string> const& file, Assignments const& assignments) {
  SettingsFile settings = file ? SettingsFile::from_path(*file) : SettingsFile();
  for (auto const& [key, value] : assignments) {
    settings.set(key, value, {.file = "Simulation", .line = 0, .column = 0, .source_line = key + " = " + value});
  }
  return settings;
}

}  // namespace gridlock::python
