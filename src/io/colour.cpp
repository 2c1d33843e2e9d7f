#include "io/colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

namespace gridlock {

namespace {

constexpr Colour from_hex(unsigned hex) {
  return {static_cast<double>(hex >> 16) / 255.0, static_cast<double>((hex >> 8) & 0xFFU) / 255.0,
          static_cast<double>(hex & 0xFFU) / 255.0};
}

int to_byte(double part) { return static_cast<int>(std::clamp(part, 0.0, 1.0) * 255.0 + 0.5); }

}  // namespace

std::string to_hex(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", to_byte(colour.red), to_byte(colour.green), to_byte(colour.blue));
}

Colour mixed(Colour from, Colour to, double share) {
  return {from.red + share * (to.red - from.red), from.green + share * (to.green - from.green),
          from.blue + share * (to.blue - from.blue)};
}

std::span<Colour const> categorical_colours() {
  static constexpr std::array colours{from_hex(0x0072B2), from_hex(0xD55E00), from_hex(0x009E73), from_hex(0xCC79A7),
                                      from_hex(0xE69F00), from_hex(0x56B4E9), from_hex(0x000000), from_hex(0xF0E442)};
  return colours;
}

Colour viridis(double t) {
  static constexpr std::array anchors{from_hex(0x440154), from_hex(0x482878), from_hex(0x3E4A89), from_hex(0x31688E),
                                      from_hex(0x26828E), from_hex(0x1F9E89), from_hex(0x35B779), from_hex(0x6DCD59),
                                      from_hex(0xB4DE2C), from_hex(0xFDE725)};
  double const place = std::clamp(t, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  std::size_t const below = std::min(static_cast<std::size_t>(place), anchors.size() - 2);
  return mixed(anchors[below], anchors[below + 1], place - static_cast<double>(below));
}

}  // namespace gridlock
