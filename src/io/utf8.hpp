#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gridlock {

/// The text as valid UTF-8 in one line: control characters become spaces, broken bytes U+FFFD.
std::string one_line(std::string_view text);

/// The bytes before the first one that is no text: broken UTF-8 or a control character other than a tab.
std::size_t text_length(std::string_view text);

}  // namespace gridlock
