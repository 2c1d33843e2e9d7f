#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {

/// Returns for each place in the order of the keys of all ranks the largest number that has at most that many keys
/// below it, among numbers without bits above `highest_bit`: this is the key at that place, if there is one. Contract:
/// all keys differ. `count_below(number)` counts the keys of this rank, and add_up(counts) adds the counts of all
/// ranks. All ranks call it. Cost: a round of messages for each bit.
template <class CountBelow, class AddUp>
std::vector<std::uint64_t> keys_at(std::span<std::uint64_t const> places, std::uint64_t highest_bit,
                                   CountBelow count_below, AddUp add_up) {
  std::vector<std::uint64_t> keys(places.size(), 0);
  std::vector<std::uint64_t> below(places.size());
  for (std::uint64_t bit = highest_bit; bit != 0; bit >>= 1U) {
    for (std::size_t k = 0; k < keys.size(); ++k) below[k] = static_cast<std::uint64_t>(count_below(keys[k] | bit));
    add_up(std::span(below));
    for (std::size_t k = 0; k < keys.size(); ++k) {
      if (below[k] <= places[k]) keys[k] |= bit;
    }
  }
  return keys;
}

}  // namespace gridlock
