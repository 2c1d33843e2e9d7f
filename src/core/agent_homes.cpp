#include "gridlock/core/detail/agent_homes.hpp"

#include <algorithm>
#include <bit>

#include "core/add_up_over_ranks.hpp"

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
  std::vector<Id> first(blocks, 0);
  Id largest = 0;
  for (Ranks::Bytes const& bytes : ranks.gather_for_all(message_of(own.empty() ? Id{0} : own.back()))) {
    largest = std::max(largest, MessageReader(bytes).next<Id>());
  }
  // Bit by bit from the highest: the largest number with no more Ids below it than there are before the block.
  for (Id bit = std::bit_floor(largest); bit != 0; bit >>= 1U) {
    std::vector<std::uint64_t> below(blocks);
    for (std::size_t b = 0; b < blocks; ++b) {
      below[b] = static_cast<std::uint64_t>(std::ranges::lower_bound(own, first[b] | bit) - own.begin());
    }
    add_up_over_ranks(ranks, below);
    for (std::size_t b = 0; b < blocks; ++b) {
      if (below[b] <= (b * agents[0] + blocks - 1) / blocks) first[b] |= bit;
    }
  }
  return first;
}

}  // namespace gridlock
