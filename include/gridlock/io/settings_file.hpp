#pragma once

/// \file
/// Settings in TOML: reading, checks, explanations and writing.
///
/// ```cpp
/// SettingsFile file = SettingsFile::from_path("gas.toml");
/// file.set("gas.temperature=2");
/// double temperature = 1.0;
/// file.read_into([&](SettingVisitor& visitor) {
///   visitor.enter("gas", "The gas.");
///   visitor.visit({.key = "temperature", .documentation = "How hot it is."}, temperature);
///   visitor.leave();
/// });
/// ```

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/setting.hpp"

namespace gridlock {

/// A function that shows every setting of one configuration to a visitor.
using Describe = std::function<void(SettingVisitor&)>;

/// The location at which a setting was given.
struct SettingLocation {
  std::string file;         ///< the file as named by the user, or "--set"
  int line = 0;             ///< from 1; 0 for --set
  int column = 0;           ///< from 1; 0 for --set
  std::string source_line;  ///< text of the line, or "key=value"
};

/// One setting with several values to try, as in `[sweep]`.
struct SettingList {
  std::string key;                               ///< key with its table: "disks.count"
  std::vector<std::string> values;               ///< in TOML, for SettingsFile::set(key, value, …); at least one
  std::vector<SettingLocation> value_locations;  ///< one for each value
  SettingLocation location;                      ///< location of the whole list
};

/// The settings that a user has given: a TOML file, and values of `--set key=value`, which override the file.
///
/// It knows only TOML; the settings and their types, units and bounds come from the visited structs. Copies are cheap:
/// a sweep copies the file and sets other values in each copy.
class SettingsFile {
 public:
  /// Makes settings without any value.
  SettingsFile();
  ~SettingsFile();
  SettingsFile(SettingsFile const& other);
  SettingsFile(SettingsFile&& other) noexcept;
  SettingsFile& operator=(SettingsFile other) noexcept;

  /// Reads a TOML file. Errors: Error for a file that cannot be read or is no TOML.
  static SettingsFile from_path(std::filesystem::path const& path);
  /// Reads a TOML text; errors give `name` as the name of the file.
  static SettingsFile from_text(std::string_view text, std::string const& name);

  /// Sets "key=value" in place of a value of the file. A value that is no TOML is taken as text, so that
  /// `disks.start=square` needs no quotes. Errors: Error for an assignment without = or with an unusable key.
  void set(std::string_view assignment);
  /// Sets the value of a key; errors give the location `where`.
  void set(std::string_view key, std::string_view value, SettingLocation const& where);

  /// Removes a key, so that its default is used.
  void leave_out(std::string_view key);

  /// Removes a top-level table of lists, such as `[sweep]`, and returns the lists in the order of the file. Keys may be
  /// dotted or quoted (`disks.count = [1]`, `"disks.count" = [1]`). Returns nothing without such a table. Errors: Error
  /// for a value that is no list, an empty list or a key given twice.
  std::vector<SettingList> take_lists(std::string_view table);

  /// Sets every setting that is in the file; all other settings keep their values.
  /// Errors: one Error with every problem found (unknown table or key, wrong type, not finite, out of bounds, unknown
  /// word); the settings are then only partly read.
  void read_into(Describe const& describe) const;

  /// Returns whether the file or --set gives a setting or a table.
  [[nodiscard]] bool is_given(std::string_view key) const;

  /// Returns the location of a key, or of the nearest table around it ("disks" for "disks.radius"); keys in lists are
  /// "disks.species[1].mass". Returns nothing if not even the outermost table is given.
  [[nodiscard]] std::optional<SettingLocation> location(std::string_view key) const;

  /// Returns the problems of an error, and adds the location of its key to each problem with a key and no location.
  [[nodiscard]] Error locate(Error const& error) const;

  /// Returns the directory for relative paths: the directory of the file, or "." for a text.
  [[nodiscard]] std::filesystem::path directory() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Returns all settings with a value as TOML, one table after the other; read_into() reads them back to the same bits.
std::string to_toml(Describe const& describe);

/// Returns an explanation of a setting for a terminal: documentation, type, unit, bounds, choices and its present value
/// as the default.
///
/// `key` is a dotted key, a table, the last part of a key ("packing_fraction"), or empty for everything.
/// Errors: Error for an unknown key, with the nearest known key.
std::string explain(Describe const& describe, std::string_view key);

/// Returns the present key of a setting whose key in earlier versions was `key`.
std::optional<std::string> renamed_setting(Describe const& describe, std::string_view key);

/// Returns the keys of all settings, in the order of their description.
std::vector<std::string> setting_keys(Describe const& describe);

/// Returns the present value of a setting, in TOML; empty if it has no value. Contract: the setting exists.
std::string value_in_toml(Describe const& describe, std::string_view key);

/// Returns the setting or table whose key is most similar to a mistyped key; empty if none is similar.
std::string nearest_setting(Describe const& describe, std::string_view key);

/// Returns the reference page of all settings in Markdown, one section for each table.
std::string reference_markdown(Describe const& describe);

}  // namespace gridlock
