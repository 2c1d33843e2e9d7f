#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace gridlock {

/// The number in four bytes of a PNG, whose first is the largest.
inline std::uint32_t number_at(std::string const& bytes, std::size_t place) {
  std::uint32_t number = 0;
  for (std::size_t i = place; i < place + 4; ++i) number = (number << 8) | static_cast<unsigned char>(bytes.at(i));
  return number;
}

}  // namespace gridlock
