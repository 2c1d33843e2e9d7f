#pragma once

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// The shortest decimal text that reads back as the same bits, and as a floating-point number: "1.0", never "1".
inline std::string double_text(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_not_of("-0123456789") == std::string::npos) text += ".0";
  return text;
}

/// The number a whole word stands for; nothing where it is no number or beyond the range of the type.
template <class Number>
std::optional<Number> parse_number(std::string_view word) {
  // from_chars knows no leading plus; "+-1" must not slip through by dropping it.
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number value{};
  auto const [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// A word of the user's in an error message, cut where it is long and with control bytes replaced.
inline std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 60;
  std::string text = "\"";
  for (char const c : word.substr(0, longest)) text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  text += word.size() > longest ? "…\"" : "\"";
  return text;
}

}  // namespace gridlock
