#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/io/settings_file.hpp"

namespace gridlock::python {

/// Settings as Python hands them over: dotted keys, values in TOML.
using Assignments = std::vector<std::pair<std::string, std::string>>;

/// A TOML file, and settings over it.
inline SettingsFile settings_of(std::optional<std::string> const& file, Assignments const& assignments) {
  SettingsFile settings = file ? SettingsFile::from_path(*file) : SettingsFile();
  for (auto const& [key, value] : assignments) {
    settings.set(key, value, {.file = "Simulation", .line = 0, .column = 0, .source_line = key + " = " + value});
  }
  return settings;
}

}  // namespace gridlock::python
