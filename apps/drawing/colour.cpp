#include "drawing/colour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace gridlock {

namespace {

constexpr Colour from_hex(unsigned hex) {
  return {static_cast<double>(hex >> 16) / 255.0, static_cast<double>((hex >> 8) & 0xFFU) / 255.0,
          static_cast<double>(hex & 0xFFU) / 255.0};
}

}  // namespace

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
  double const share = t > 0.0 ? std::min(t, 1.0) : 0.0;  // 0 for NaN
  double const place = share * static_cast<double>(anchors.size() - 1);
  std::size_t const below = std::min(static_cast<std::size_t>(place), anchors.size() - 2);
  return mixed(anchors[below], anchors[below + 1], place - static_cast<double>(below));
}

Colour colour_circle(double t) {
  double const angle = 2.0 * std::numbers::pi * t;
  constexpr double chroma = 0.12;
  double const lightness = 0.70 + 0.12 * std::cos(angle - 1.9);  // brightest at yellow, whose vivid shades are bright
  double const a = chroma * std::cos(angle);
  double const b = chroma * std::sin(angle);
  auto const cubed = [](double x) { return x * x * x; };
  double const l = cubed(lightness + 0.3963377774 * a + 0.2158037573 * b);
  double const m = cubed(lightness - 0.1055613458 * a - 0.0638541728 * b);
  double const s = cubed(lightness - 0.0894841775 * a - 1.2914855480 * b);
  auto const encoded = [](double x) {
    double const part = std::clamp(x, 0.0, 1.0);
    return part <= 0.0031308 ? 12.92 * part : 1.055 * std::pow(part, 1.0 / 2.4) - 0.055;
  };
  return {encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s),
          encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s),
          encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s)};
}

}  // namespace gridlock
