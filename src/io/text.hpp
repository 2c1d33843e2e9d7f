#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>

#include "io/utf8.hpp"

namespace gridlock {

/// Returns the shortest decimal text that reads back as the same bits, as a floating-point number: "1.0", not "1".
inline std::string double_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

/// Returns a text without spaces and tabs at both ends.
inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// Returns the number that a whole word denotes; nothing if it is not a number or outside the range of the type.
template <class Number>
std::optional<Number> parse_number(std::string_view word) {
  // from_chars accepts no leading plus, so it is removed; "+-1" must remain invalid.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number value{};
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Returns at most `longest` bytes of a text as one_line(), cut between characters of UTF-8.
inline std::string cut(std::string_view text, std::size_t longest) {
  std::size_t end = std::min(text.size(), longest);
  while (end < text.size() && end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  std::string const result = one_line(text.substr(0, end));
  return end < text.size() ? result + "…" : result;
}

/// Returns a word of the user in quotes, for error messages.
inline std::string in_quotes(std::string_view word) { return '"' + cut(word, 60) + '"'; }

/// Returns the dotted key of a setting in a table, as "disks.count"; the key alone if `table` is empty.
inline std::string dotted(std::string_view table, std::string_view key) {
  return table.empty() ? std::string(key) : fmt::format("{}.{}", table, key);
}

/// Returns a line of the user's file for error messages, without spaces at both ends, up to the first non-text byte.
inline std::string shown_line(std::string_view line) {
  constexpr std::string_view blanks = " \t\r";
  constexpr std::size_t shown = 100;
  std::size_t const begin = line.find_first_not_of(blanks);
  if (begin == std::string_view::npos) return "";
  line = line.substr(begin, line.find_last_not_of(blanks) + 1 - begin);
  // Lines are quoted for each value in them, and may be long.
  std::size_t const length = text_length(line.substr(0, 2 * shown));
  return cut(line.substr(0, length), shown) + (length > 0 && length < std::min(line.size(), shown) ? "…" : "");
}

}  // namespace gridlock
