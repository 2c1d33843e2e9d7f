#pragma once

#include <string>

namespace gridlock {

/// Returns the shortest text that reads back as the same number, as fmt writes it. Sources of gridlock::grid use it,
/// because they need nothing but the standard library.
std::string number_text(double value);

}  // namespace gridlock
