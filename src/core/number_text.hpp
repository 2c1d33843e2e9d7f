#pragma once

#include <string>

namespace gridlock {

/// The shortest text that reads back as the same number, as fmt writes it: for the sources of gridlock::grid, which
/// need the standard library alone.
std::string number_text(double value);

}  // namespace gridlock
