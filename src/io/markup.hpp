#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace gridlock {

/// The text as it may stand between tags or in a quoted attribute of XML and HTML: & < > " ' become references,
/// control characters that no XML document may hold go, and bytes that are no UTF-8 become U+FFFD.
std::string escape_markup(std::string_view text);

/// The text as valid UTF-8 in one line: control characters become spaces, broken bytes U+FFFD.
std::string one_line(std::string_view text);

/// The bytes before the first one that is no text: broken UTF-8 or a control character other than a tab.
std::size_t text_length(std::string_view text);

/// Base64 with padding (RFC 4648).
std::string to_base64(std::string_view bytes);

}  // namespace gridlock
