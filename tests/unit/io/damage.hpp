#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "gridlock/core/random.hpp"

namespace gridlock {

/// The text with one to four accidents: a byte changed, a piece lost, doubled or moved, the end cut off. A function of
/// the seed alone.
inline std::string damaged(std::string text, std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  auto const place = [&] { return random.below(text.size() + 1); };
  constexpr std::string_view nasty = "=[]{}\"'.,:#-+e0919 \t\r\n\0\x01\x80\xff\\TFn/";
  for (std::uint64_t accidents = 1 + random.below(4); accidents > 0; --accidents) {
    std::size_t const at = place();
    std::size_t const length = random.below(12);
    switch (random.below(6)) {
      case 0:
        if (at < text.size()) text[at] = nasty[random.below(nasty.size())];
        break;
      case 1:
        text.insert(at, 1, nasty[random.below(nasty.size())]);
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(place(), std::string(text, at, length));
        break;
      case 4:
        text.insert(at, std::to_string(random.bits()));
        break;
      default:
        if (random.below(4) == 0) text.resize(at);
        break;
    }
  }
  return text;
}

}  // namespace gridlock
