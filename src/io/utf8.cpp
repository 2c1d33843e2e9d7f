#include "io/utf8.hpp"

#include <cstddef>

namespace gridlock {

namespace {

constexpr std::string_view replacement_character = "\xEF\xBF\xBD";

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == '\x7F'; }

/// Returns whether a character is a control character, also one of U+0080 to U+009F, which some terminals obey.
bool is_control(std::string_view character) {
  return is_control(character.front()) ||
         (character.front() == '\xC2' && static_cast<unsigned char>(character[1]) < 0xA0);
}

/// Returns the length in bytes of the UTF-8 character at the start of a text; 0 if it is not well-formed (RFC 3629).
std::size_t length_of_character(std::string_view text) {
  auto const byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  unsigned const first = byte(0);
  if (first < 0x80) return 1;
  std::size_t const length = first >= 0xC2 && first < 0xE0   ? 2
                             : first >= 0xE0 && first < 0xF0 ? 3
                             : first >= 0xF0 && first < 0xF5 ? 4
                                                             : 0;
  if (length == 0 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  }
  unsigned const second = byte(1);
  bool const is_overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  bool const is_surrogate = first == 0xED && second >= 0xA0;
  bool const is_beyond_unicode = first == 0xF4 && second >= 0x90;
  // U+FFFE and U+FFFF are not characters.
  bool const is_noncharacter = first == 0xEF && second == 0xBF && byte(2) >= 0xBE;
  return is_overlong || is_surrogate || is_beyond_unicode || is_noncharacter ? 0 : length;
}

/// Calls visit(character) for every character; each invalid byte becomes a replacement character.
template <class Visit>
void for_each_character(std::string_view text, Visit visit) {
  while (!text.empty()) {
    std::size_t const length = length_of_character(text);
    visit(length == 0 ? replacement_character : text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line;
  line.reserve(text.size());
  for_each_character(text, [&](std::string_view character) {
    if (is_control(character)) {
      line += ' ';
    } else {
      line += character;
    }
  });
  return line;
}

std::size_t text_length(std::string_view text) {
  std::size_t end = 0;
  while (end < text.size()) {
    std::size_t const length = length_of_character(text.substr(end));
    if (length == 0 || (text[end] != '\t' && is_control(text.substr(end, length)))) break;
    end += length;
  }
  return end;
}

}  // namespace gridlock
