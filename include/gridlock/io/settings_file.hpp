#pragma once

/// \file
/// Settings in TOML: read, check, explain and write them.
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

/// Shows every setting of a configuration to a visitor: `describe(configuration, visitor)`, the configuration bound.
using Describe = std::function<void(SettingVisitor&)>;

/// Where a setting was given.
struct SettingLocation {
  std::string file;         ///< the file as named by the user, or "--set"
  int line = 0;             ///< from 1; 0 for --set
  int column = 0;           ///< from 1; 0 for --set
  std::string source_line;  ///< the text of the line, or "key=value"
};

/// One setting with several values to try, as in `[sweep]`.
struct SettingList {
  std::string key;                  ///< dotted
  std::vector<std::string> values;  ///< TOML, as SettingsFile::set(key, value, …) takes them; at least one
  std::vector<SettingLocation> value_locations;  ///< of each value
  SettingLocation location;                      ///< of the whole list
};

/// The settings a user has given: a TOML file, and on top of it `--set key=value`.
///
/// Nothing but TOML is known here; what may be given, with type, unit and bounds, the visited settings say themselves.
/// A value, cheap to copy: a sweep copies the file and sets other values on each copy.
class SettingsFile {
 public:
  /// Nothing given.
  SettingsFile();
  ~SettingsFile();
  SettingsFile(SettingsFile const& other);
  SettingsFile(SettingsFile&& other) noexcept;
  SettingsFile& operator=(SettingsFile other) noexcept;

  /// Errors: Error for a file that cannot be read or is no TOML.
  static SettingsFile from_path(std::filesystem::path const& path);
  /// The same from a text; `name` names the file in errors.
  static SettingsFile from_text(std::string_view text, std::string const& name);

  /// Sets "key=value" over what the file says. The value is TOML; what is no TOML value is taken as text, so that
  /// `disks.start=square` needs no quotes. Errors: Error for an assignment without = or with an unusable key.
  void set(std::string_view assignment);
  /// The same, with the place to blame in errors.
  void set(std::string_view key, std::string_view value, SettingLocation const& where);

  /// Forgets what is said of a dotted key, so that its default counts.
  void leave_out(std::string_view key);

  /// Takes a top-level table of lists, such as `[sweep]`, out of the file: what is left is for read_into(). Keys may be
  /// dotted or quoted (`disks.count = [1]`, `"disks.count" = [1]`); the lists come in the order of the file.
  /// Empty where there is no such table. Errors: Error for anything but lists, for empty lists, for keys given twice.
  std::vector<SettingList> take_lists(std::string_view table);

  /// Gives every setting that is in the file its value; the others keep theirs.
  /// Errors: one Error with every problem found (unknown table or key, wrong type, not finite, out of bounds, unknown
  /// word); the settings are then only partly read.
  void read_into(Describe const& describe) const;

  /// Whether the file or --set gives this dotted key (a setting or a table).
  [[nodiscard]] bool is_given(std::string_view key) const;

  /// Where a dotted key is given, or the nearest table around it that is ("disks" for "disks.radius"); list entries are
  /// "disks.species[1].mass". Nothing where not even the outermost table is given.
  [[nodiscard]] std::optional<SettingLocation> location(std::string_view key) const;

  /// The same problems, each with the place its key was given at, where it carries a key and no place yet.
  [[nodiscard]] Error locate(Error const& error) const;

  /// The directory relative paths of the file are meant from: that of the file, "." for a text.
  [[nodiscard]] std::filesystem::path directory() const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// Every setting that has a value as TOML, one table after the other; read back by read_into() to the same bits.
std::string to_toml(Describe const& describe);

/// The meaning of a setting, for a terminal: documentation, type, unit, bounds, choices, default (the value it has
/// now).
///
/// `key` is a dotted key, a table, the last part of a key ("packing_fraction"), or empty for everything.
/// Errors: Error for an unknown key, with the nearest one.
std::string explain(Describe const& describe, std::string_view key);

/// The dotted key that a setting has now, where `key` is its dotted key of earlier versions.
std::optional<std::string> renamed_setting(Describe const& describe, std::string_view key);

/// The dotted key of every setting, in the order they are described.
std::vector<std::string> setting_keys(Describe const& describe);

/// The value that a setting has now, in TOML; empty where it has none. Contract: there is such a setting.
std::string value_in_toml(Describe const& describe, std::string_view key);

/// The setting or table that a key may be a slip of; empty where none is near.
std::string nearest_setting(Describe const& describe, std::string_view key);

/// The reference page in Markdown, one section for each table.
std::string reference_markdown(Describe const& describe);

}  // namespace gridlock
