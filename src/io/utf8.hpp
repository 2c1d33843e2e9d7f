#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gridlock {

/// Returns a text as valid UTF-8 on one line: control characters become spaces, invalid bytes U+FFFD.
std::string one_line(std::string_view text);

/// Returns the number of bytes before the first invalid UTF-8 or control character other than a tab.
std::size_t text_length(std::string_view text);

}  // namespace gridlock
