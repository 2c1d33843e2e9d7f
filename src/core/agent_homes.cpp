#include "gridlock/core/detail/agent_homes.hpp"

#include <algorithm>

#include "core/add_up_over_ranks.hpp"
#include "core/keys_at.hpp"

namespace gridlock {

std::uint64_t sum_over_ranks(Ranks& ranks, std::uint64_t own) {
  add_up_over_ranks(ranks, std::span(&own, 1));
  return own;
}

std::uint64_t count_of_arrivals(Ranks& ranks, std::vector<std::uint64_t> leaving) {
  add_up_over_ranks(ranks, leaving);
  return leaving[ranks.rank()];
}

std::vector<Id> first_ids_of_blocks(Ranks& ranks, std::span<Id const> own) {
  std::size_t const blocks = ranks.count();
  std::vector<std::uint64_t> agents{own.size()};
  add_up_over_ranks(ranks, agents);
  std::vector<std::uint64_t> places(blocks);
  for (std::size_t b = 0; b < blocks; ++b) places[b] = (b * agents[0] + blocks - 1) / blocks;
  return keys_at(
      places, highest_bit_of_all(ranks, own.empty() ? Id{0} : own.back()),
      [&](Id id) { return std::ranges::lower_bound(own, id) - own.begin(); },
      [&](std::span<std::uint64_t> counts) { add_up_over_ranks(ranks, counts); });
}

}  // namespace gridlock
