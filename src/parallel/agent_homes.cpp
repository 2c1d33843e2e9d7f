#include "gridlock/parallel/detail/agent_homes.hpp"

#include <algorithm>

#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/keys_at.hpp"

namespace gridlock {

std::uint64_t count_of_arrivals(Communicator& ranks, std::vector<std::uint64_t> leaving) {
  all_sum(ranks, leaving);
  return leaving[ranks.rank()];
}

std::vector<Id> first_ids_of_blocks(Communicator& ranks, std::span<Id const> own) {
  std::size_t const blocks = ranks.count();
  std::vector<std::uint64_t> agents{own.size()};
  all_sum(ranks, agents);
  std::vector<std::uint64_t> places(blocks);
  for (std::size_t b = 0; b < blocks; ++b) places[b] = (b * agents[0] + blocks - 1) / blocks;
  return keys_at(
      places, highest_bit_of_all(ranks, own.empty() ? Id{0} : own.back()),
      [&](Id id) { return std::ranges::lower_bound(own, id) - own.begin(); },
      [&](std::span<std::uint64_t> counts) { all_sum(ranks, counts); });
}

}  // namespace gridlock
