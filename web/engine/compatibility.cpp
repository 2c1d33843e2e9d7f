#include "compatibility.hpp"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

namespace std {  // NOLINT(cert-dcl58-cpp): see the header

from_chars_result from_chars(char const* first, char const* last, double& value) {
  auto const [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}

/// Writes the shortest text that reads back as the same bits. fmt chooses the format, as its only caller number_text()
/// requires.
to_chars_result to_chars(char* first, char* last, double value, chars_format /*format*/) {
  auto const room = static_cast<size_t>(last - first);
  auto const [end, length] = fmt::format_to_n(first, room, "{}", value);
  if (length > room) return {last, errc::value_too_large};
  return {end, errc{}};
}

}  // namespace std
