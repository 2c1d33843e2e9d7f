#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

namespace gridlock {

/// Dotted keys of settings and their values in TOML.
using SettingTexts = std::map<std::string, std::string>;

/// The settings of a TOML text. Errors: Error for a text that is not TOML; `name` names the file.
SettingTexts setting_texts(std::string const& toml, std::string const& name);

/// A setting with one value in one place and another in another.
struct SettingDifference {
  std::string key;
  std::string here;   ///< TOML; empty where it is left out
  std::string there;  ///< the same

  friend bool operator==(SettingDifference const&, SettingDifference const&) = default;
};

/// The settings that a run which is made longer may change.
std::set<std::string> const& settings_of_length();

/// The first setting, in alphabetical order, that differs; nothing where all agree. Neither the `ignored` keys count
/// nor engine.threads, on which no result depends.
std::optional<SettingDifference> find_difference(SettingTexts const& here, SettingTexts const& there,
                                                 std::set<std::string> const& ignored = {});

/// "run.steps is 10 in first, and left out in second".
std::string to_text(SettingDifference const& difference, std::string const& here, std::string const& there);

}  // namespace gridlock
