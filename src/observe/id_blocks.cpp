#include "observe/id_blocks.hpp"

#include <algorithm>
#include <cstdint>
#include <span>

#include "parallel/keys_at.hpp"

namespace gridlock {

IdBlocks::IdBlocks(Snapshot const& now, IdIndex const& index) {
  std::array<std::uint64_t, 1> agents{index.size()};
  now.counts(agents);
  std::array<std::uint64_t, count> places{};
  for (std::size_t b = 0; b < count; ++b) places[b] = (b * agents[0] + count - 1) / count;
  std::ranges::copy(keys_at(
                        places, Id{1} << 63U, [&](Id id) { return index.count_below(id); },
                        [&](std::span<std::uint64_t> counts) { now.counts(counts); }),
                    first_.begin());
}

}  // namespace gridlock
