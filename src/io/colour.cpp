#include "io/colour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace gridlock {

namespace {

constexpr Colour from_hex(unsigned hex) {
  return {static_cast<double>(hex >> 16) / 255.0, static_cast<double>((hex >> 8) & 0xFFU) / 255.0,
          static_cast<double>(hex & 0xFFU) / 255.0};
}

int to_byte(double part) { return static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * 255.0)); }

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
  static constexpr std::array anchors{from_hex(0x440154), from_hex(0x481769), from_hex(0x472A7A), from_hex(0x433D84),
                                      from_hex(0x3D4E8A), from_hex(0x355E8D), from_hex(0x2E6D8E), from_hex(0x297B8E),
                                      from_hex(0x23898E), from_hex(0x1F978B), from_hex(0x21A585), from_hex(0x2EB37C),
                                      from_hex(0x46C06F), from_hex(0x65CB5E), from_hex(0x89D548), from_hex(0xB0DD2F),
                                      from_hex(0xD8E219), from_hex(0xFDE725)};
  double const share = t > 0.0 ? std::min(t, 1.0) : 0.0;  // and 0 for nan
  double const place = share * static_cast<double>(anchors.size() - 1);
  std::size_t const below = std::min(static_cast<std::size_t>(place), anchors.size() - 2);
  return mixed(anchors[below], anchors[below + 1], place - static_cast<double>(below));
}

}  // namespace gridlock
