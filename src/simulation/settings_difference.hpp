#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

namespace gridlock {

/// Values of settings in TOML by dotted key.
using SettingTexts = std::map<std::string, std::string>;

/// Returns the settings of a TOML text. Errors: Error if the text is not TOML; `name` is the name of the file.
SettingTexts setting_texts(std::string const& toml, std::string const& name);

/// A setting with different values in two files.
struct SettingDifference {
  std::string key;
  std::string here;   ///< value in the first file as TOML; empty if missing
  std::string there;  ///< value in the second file as TOML; empty if missing

  friend bool operator==(SettingDifference const&, SettingDifference const&) = default;
};

/// Returns the keys of settings that may change when a run is lengthened.
std::set<std::string> const& settings_of_length();

/// Returns whether a setting can change a result: all can but engine.threads and engine.device.
bool affects_results(std::string_view key);

/// Returns the first difference in alphabetical order; nothing if all settings agree. The `ignored` keys, and those
/// that affect no result, are not compared.
std::optional<SettingDifference> find_difference(SettingTexts const& here, SettingTexts const& there,
                                                 std::set<std::string> const& ignored = {});

/// Returns a sentence part such as "run.steps is 10 in first, and left out in second".
std::string to_text(SettingDifference const& difference, std::string const& here, std::string const& there);

}  // namespace gridlock
