#include "observe/id_blocks.hpp"

#include <cstdint>

namespace gridlock {

IdBlocks::IdBlocks(Snapshot const& now, IdIndex const& index) {
  std::array<std::uint64_t, 1> agents{index.size()};
  now.add_up(agents);
  // Bit by bit from the highest: the largest number with no more Ids below it than there are before the block.
  for (Id bit = Id{1} << 63U; bit != 0; bit >>= 1U) {
    std::array<std::uint64_t, count> below{};
    for (std::size_t b = 0; b < count; ++b) below[b] = index.count_below(first_[b] | bit);
    now.add_up(below);
    for (std::size_t b = 0; b < count; ++b) {
      std::uint64_t const before = (b * agents[0] + count - 1) / count;
      if (below[b] <= before) first_[b] |= bit;
    }
  }
}

}  // namespace gridlock
