#pragma once

#include <string>

namespace gridlock {

/// Returns the address at which the page runs a set-up: the TOML text deflated (RFC 1951) and in base64url (RFC 4648),
/// without padding, behind "playground.html#toml=".
std::string playground_link(std::string const& toml);

}  // namespace gridlock
