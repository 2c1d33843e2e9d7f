#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace gridlock {

/// Whether bytes begin as a file of gzip does.
bool is_gzip(std::string_view bytes);

/// What gzip packed, of one part or of several one after the other; nothing where the bytes are damaged or cut off, or
/// would become longer than `longest`.
std::optional<std::string> unpacked_gzip(std::string_view bytes, std::size_t longest);

}  // namespace gridlock
