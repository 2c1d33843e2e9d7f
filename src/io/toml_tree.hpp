#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/settings_file.hpp"

namespace gridlock {

/// A value of TOML and its place.
///
/// Our own tree instead of toml++'s, for two reasons: its nodes lose their place when they are copied, which merging
/// --set over a file needs, and its headers, slow to compile, stay within one file.
struct TomlValue {
  enum class Kind { boolean, integer, number, text, date, array, table };

  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;
  std::string text;                ///< of a text or a date
  std::vector<TomlValue> items;    ///< of an array or a table
  std::vector<std::string> names;  ///< of the items of a table, in their order
  SettingLocation location;        ///< of the value
  SettingLocation key_location;    ///< of its key, for a member of a table
  std::string as_typed;            ///< what --set said, where the value comes from there

  [[nodiscard]] bool is_table() const { return kind == Kind::table; }
  /// The member of a table; null where there is none or this is no table.
  [[nodiscard]] TomlValue const* find(std::string_view name) const;
  [[nodiscard]] TomlValue* find(std::string_view name);
  /// Adds a member, or replaces the one of that name.
  TomlValue& put(std::string_view name, TomlValue value);
};

/// The table that a text of TOML describes. Errors: Error with line and column.
TomlValue parse_toml(std::string_view text, std::string const& file);

/// The value that a text describes: TOML, or the text itself where it is none. Every part of it has the place `where`.
TomlValue parse_toml_value(std::string_view text, SettingLocation const& where);

/// The value as TOML on one line.
std::string to_toml(TomlValue const& value);

/// A text as a basic string of TOML, in quotes.
std::string toml_quoted(std::string_view text);

/// A key, in quotes where TOML asks for them.
std::string toml_key(std::string_view key);

/// The value in words, for "… is 0.5, but must be …".
std::string in_words(TomlValue const& value);

/// A problem with something that was given there.
Problem problem_at(SettingLocation const& where, std::string key, std::string what, std::string hint);

}  // namespace gridlock
