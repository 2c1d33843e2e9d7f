#include "io/toml_tree.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <sstream>
#include <utility>

#include "io/text.hpp"

namespace gridlock {

namespace {

using Kind = TomlValue::Kind;

/// Maximum depth of nested values. No setting is nested as deeply, and a deeper file could overflow the stack.
constexpr int deepest_value = 32;
constexpr int max_dots = 64;

/// The lines of a text, to quote them in errors.
class SourceLines {
 public:
  SourceLines(std::string_view text, std::string file) : file_(std::move(file)) {
    for (std::size_t at = 0; at <= text.size();) {
      std::size_t const end = std::min(text.find('\n', at), text.size());
      lines_.push_back(text.substr(at, end - at));
      at = end + 1;
    }
  }

  [[nodiscard]] SettingLocation at(toml::source_position const& position) const {
    SettingLocation where{
        .file = file_, .line = static_cast<int>(position.line), .column = static_cast<int>(position.column)};
    if (position.line >= 1 && position.line <= lines_.size()) where.source_line = shown_line(lines_[position.line - 1]);
    return where;
  }

 private:
  std::string file_;
  std::vector<std::string_view> lines_;
};

TomlValue convert(toml::node const& node, SourceLines const& lines, int depth);

TomlValue convert_table(toml::table const& table, SourceLines const& lines, int depth) {
  TomlValue value{.kind = Kind::table};
  for (auto const& [key, member] : table) {
    TomlValue item = convert(member, lines, depth + 1);
    item.key_location = lines.at(key.source().begin);
    // toml++ stores no position for a table that a dotted key forms.
    if (item.location.line == 0) item.location = item.key_location;
    value.names.emplace_back(key.str());
    value.items.push_back(std::move(item));
  }
  return value;
}

TomlValue convert(toml::node const& node, SourceLines const& lines, int depth) {
  if (depth > deepest_value) {
    SettingLocation const where = lines.at(node.source().begin);
    throw Error(Problem{.what = fmt::format("tables and lists lie {} deep within one another", depth),
                        .hint = "is this a file of settings?",
                        .file = where.file,
                        .line = where.line,
                        .column = where.column,
                        .source_line = where.source_line});
  }
  TomlValue value;
  switch (node.type()) {
    case toml::node_type::table:
      value = convert_table(*node.as_table(), lines, depth);
      break;
    case toml::node_type::array:
      value.kind = Kind::array;
      for (auto const& item : *node.as_array()) value.items.push_back(convert(item, lines, depth + 1));
      break;
    case toml::node_type::string:
      value.kind = Kind::text;
      value.text = node.as_string()->get();
      break;
    case toml::node_type::integer:
      value.kind = Kind::integer;
      value.integer = node.as_integer()->get();
      break;
    case toml::node_type::floating_point:
      value.kind = Kind::number;
      value.number = node.as_floating_point()->get();
      break;
    case toml::node_type::boolean:
      value.kind = Kind::boolean;
      value.boolean = node.as_boolean()->get();
      break;
    default: {
      value.kind = Kind::date;
      std::ostringstream text;
      if (auto const* date = node.as_date()) text << date->get();
      if (auto const* time = node.as_time()) text << time->get();
      if (auto const* both = node.as_date_time()) text << both->get();
      value.text = text.str();
    }
  }
  value.location = lines.at(node.source().begin);
  return value;
}

/// Returns whether a key has more than max_dots dotted parts. Each part becomes a nested table, and the destruction of
/// thousands of nested tables overflows the stack.
bool has_bottomless_key(std::string_view text) {
  int dots = 0;
  bool is_comment = false;
  bool is_line_begin = true;
  for (char const c : text) {
    if (c == '\n') {
      is_line_begin = true;
      is_comment = false;
      dots = 0;
    } else if (is_line_begin && c != ' ' && c != '\t') {
      is_line_begin = false;
      is_comment = c == '#';
    }
    if (c == ',' || c == '=') dots = 0;
    if (c == '.' && !is_comment && ++dots > max_dots) return true;
  }
  return false;
}

/// Returns a hint for a line of invalid TOML, from the text after the equals sign.
std::string hint_for_value(std::string_view value) {
  constexpr std::string_view digits = "0123456789_";
  bool const is_number = value.find_first_not_of("0123456789_+-.,eE") == value.npos;
  auto const is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (value.front() == '"' || value.front() == '\'') {
    bool const is_whole = value.size() > 1 && value.back() == value.front();
    return is_whole ? "give every key and every table once" : "a text is written between two quotes, on one line";
  }
  if (!is_number && std::isalpha(static_cast<unsigned char>(value.front()))) {
    return "a word has to stand in quotes, as in start = \"square\"";
  }
  if (!is_number) return "settings are lines of TOML, as in count = 841 under [disks]";
  if (value.find(',') != value.npos) return "numbers have a decimal point and no comma, as in 0.7 and 10_000";
  if (std::size_t const point = value.find('.'); point != value.npos) {
    bool const has_digits =
        point > 0 && is_digit(value[point - 1]) && point + 1 < value.size() && is_digit(value[point + 1]);
    if (!has_digits) return "numbers have a digit on both sides of the point: 0.5, 1.0, 5e-3";
  }
  constexpr std::size_t digits_of_64_bits = 19;
  if (value.size() >= digits_of_64_bits && value.find_first_not_of(digits, 1) == value.npos) {
    return "whole numbers of TOML end at 9223372036854775807 (2⁶³ − 1); a seed above that, up to "
           "18446744073709551615 (2⁶⁴ − 1), has to stand in quotes";
  }
  return "give every key and every table once";
}

/// Returns a hint for a line of invalid TOML. The parser reports causes only as prose, so the line itself is examined.
std::string hint_for(std::string_view line) {
  // shown_line() ends in "…" at bytes that are not text.
  if (line.empty() || line.find("…") != line.npos) {
    return "is this the right file? settings are text, as in count = 841 under [disks]";
  }
  std::string_view const text = trimmed(line);
  if (text.starts_with('[') && text.ends_with(']')) return "give every key and every table once";
  std::size_t const equals = text.find('=');
  std::string_view const value = equals == text.npos ? std::string_view() : trimmed(text.substr(equals + 1));
  return value.empty() ? "settings are lines of TOML, as in count = 841 under [disks]" : hint_for_value(value);
}

void relocate(TomlValue& value, SettingLocation const& where) {
  value.location = where;
  value.key_location = where;
  for (TomlValue& item : value.items) relocate(item, where);
}

}  // namespace

TomlValue const* TomlValue::find(std::string_view name) const {
  if (!is_table()) return nullptr;
  auto const found = std::ranges::find(names, name);
  return found == names.end() ? nullptr : &items[static_cast<std::size_t>(found - names.begin())];
}

TomlValue* TomlValue::find(std::string_view name) { return const_cast<TomlValue*>(std::as_const(*this).find(name)); }

TomlValue& TomlValue::put(std::string_view name, TomlValue value) {
  if (TomlValue* existing = find(name)) return *existing = std::move(value);
  names.emplace_back(name);
  items.push_back(std::move(value));
  return items.back();
}

TomlValue parse_toml(std::string_view text, std::string const& file) {
  if (has_bottomless_key(text)) {
    throw Error(Problem{.what = fmt::format("a key has more than {} dotted parts", max_dots),
                        .hint = "is this a file of settings?",
                        .file = file});
  }
  SourceLines const lines(text, file);
  try {
    return convert(toml::parse(text, file), lines, 0);
  } catch (toml::parse_error const& error) {
    SettingLocation const where = lines.at(error.source().begin);
    throw Error(Problem{.what = fmt::format("this is not TOML: {}", error.description()),
                        .hint = hint_for(where.source_line),
                        .file = where.file,
                        .line = where.line,
                        .column = where.column,
                        .source_line = where.source_line});
  }
}

TomlValue parse_toml_value(std::string_view text, SettingLocation const& where) {
  TomlValue value{.kind = Kind::text, .text = std::string(text)};
  try {
    TomlValue document = parse_toml(fmt::format("value = {}", text), where.file);
    // With more than one member the text contained further lines, so it counts as plain text.
    if (document.items.size() == 1) value = std::move(document.items.front());
  } catch (Error const&) {
    // The text is not TOML, so the value is the text itself.
  }
  relocate(value, where);
  value.as_typed = text;
  return value;
}

std::string toml_quoted(std::string_view text) {
  std::string result = "\"";
  for (char const c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string toml_key(std::string_view key) {
  constexpr std::string_view bare = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
  bool const is_bare = !key.empty() && key.find_first_not_of(bare) == std::string_view::npos;
  return is_bare ? std::string(key) : toml_quoted(key);
}

std::string to_toml(TomlValue const& value) {
  switch (value.kind) {
    case Kind::boolean:
      return value.boolean ? "true" : "false";
    case Kind::integer:
      return fmt::format("{}", value.integer);
    case Kind::number:
      return double_text(value.number);
    case Kind::text:
      return toml_quoted(value.text);
    case Kind::date:
      return value.text;
    case Kind::array:
    case Kind::table:
      break;
  }
  std::string inside;
  for (std::size_t i = 0; i < value.items.size(); ++i) {
    if (i > 0) inside += ", ";
    if (value.is_table()) inside += toml_key(value.names[i]) + " = ";
    inside += to_toml(value.items[i]);
  }
  if (!value.is_table()) return fmt::format("[{}]", inside);
  return inside.empty() ? "{}" : fmt::format("{{ {} }}", inside);
}

std::string in_words(TomlValue const& value) {
  switch (value.kind) {
    case Kind::boolean:
    case Kind::integer:
    case Kind::number:
      return to_toml(value);
    case Kind::text:
      return fmt::format("the text {}", in_quotes(value.text));
    case Kind::date:
      return fmt::format("the date {}", value.text);
    case Kind::array:
      return value.items.empty() ? "an empty list" : "a list";
    case Kind::table:
      return "a table";
  }
  return "";
}

Problem problem_at(SettingLocation const& where, std::string key, std::string what, std::string hint) {
  return {.what = std::move(what),
          .hint = std::move(hint),
          .key = std::move(key),
          .file = where.file,
          .line = where.line,
          .column = where.column,
          .source_line = where.source_line};
}

}  // namespace gridlock
