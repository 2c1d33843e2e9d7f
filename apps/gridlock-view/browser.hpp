#pragma once

#include <string>

namespace gridlock::view {

/// Opens an address in the user's browser by xdg-open if a desktop is running; does nothing otherwise.
void open_browser(std::string const& address);

}  // namespace gridlock::view
