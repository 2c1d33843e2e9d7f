#include "gridlock/model/agent_sums.hpp"

#include "core/add_up_over_ranks.hpp"

namespace gridlock {

SumsOfAll SumsOfAll::over(Ranks& ranks) {
  return {.add_up = [&ranks](std::span<ExactSum> sums) { add_up_over_ranks(ranks, sums); },
          .add_up_counts = [&ranks](std::span<std::uint64_t> counts) { add_up_over_ranks(ranks, counts); },
          .least = [&ranks](double value) { return least_over_ranks(ranks, value); }};
}

}  // namespace gridlock
