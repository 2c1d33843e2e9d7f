#pragma once

#include <string>

namespace gridlock {

/// Whether a text says something.
inline bool holds(std::string const& text, std::string const& part) { return text.find(part) != std::string::npos; }

}  // namespace gridlock
