#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"

namespace gridlock {

/// A value of TOML with its position in the file.
///
/// toml++'s own nodes lose their position when they are copied, which merging --set into a file needs. This tree also
/// keeps the headers of toml++, slow to compile, within one source file.
struct TomlValue {
  enum class Kind { boolean, integer, number, text, date, array, table };

  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;                ///< value of a text or date
  std::vector<TomlValue> items;    ///< elements of an array, or values of a table
  std::vector<std::string> names;  ///< names of the values of a table, in the same order
  SettingLocation location;        ///< position of the value
  SettingLocation key_location;    ///< position of the key, for a value in a table
  std::string as_typed;            ///< text given to --set; empty for a value from the file

  [[nodiscard]] bool is_table() const { return kind == Kind::table; }
  /// Returns the value with this name in a table; null if there is none or this is no table.
  [[nodiscard]] TomlValue const* find(std::string_view name) const;
  [[nodiscard]] TomlValue* find(std::string_view name);
  /// Adds a value to a table, or replaces the value of that name.
  TomlValue& put(std::string_view name, TomlValue value);
};

/// Parses a text of TOML into a table. Errors: Error with line and column.
TomlValue parse_toml(std::string_view text, std::string const& file);

/// Parses a value in TOML; a text that is not TOML becomes a text value. All parts get the position `where`.
TomlValue parse_toml_value(std::string_view text, SettingLocation const& where);

/// Returns a value as TOML on one line.
std::string to_toml(TomlValue const& value);

/// Returns a text as a basic string of TOML, in quotes.
std::string toml_quoted(std::string_view text);

/// Returns a key, in quotes if TOML requires them.
std::string toml_key(std::string_view key);

/// Returns a value in words for the sentence "… is 0.5, but must be …".
std::string in_words(TomlValue const& value);

/// Returns a problem at the given position of the settings.
Problem problem_at(SettingLocation const& where, std::string key, std::string what, std::string hint);

}  // namespace gridlock
