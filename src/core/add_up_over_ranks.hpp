#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/ranks.hpp"

namespace gridlock {

/// Each number becomes the sum of those of all ranks, by add(sum, number). All call it.
template <class Number, class Add>
void add_up_over_ranks(Ranks& ranks, std::span<Number> numbers, Add add) {
  if (ranks.count() == 1 || numbers.empty()) return;
  Ranks::Bytes const all =
      merge_for_all(ranks, message_of_all(std::span<Number const>(numbers)),
                    [&](Ranks::Bytes const& left, Ranks::Bytes const& right) {
                      std::vector<Number> sums = MessageReader(left).next_values<Number>(numbers.size());
                      std::vector<Number> const others = MessageReader(right).next_values<Number>(numbers.size());
                      for (std::size_t k = 0; k < sums.size(); ++k) add(sums[k], others[k]);
                      return message_of_all(std::span<Number const>(sums));
                    });
  MessageReader(all).read_into(numbers);
}
inline void add_up_over_ranks(Ranks& ranks, std::span<std::uint64_t> counts) {
  add_up_over_ranks(ranks, counts, [](std::uint64_t& sum, std::uint64_t other) { sum += other; });
}

inline void add_up_over_ranks(Ranks& ranks, std::span<ExactSum> sums) {
  add_up_over_ranks(ranks, sums, [](ExactSum& sum, ExactSum const& other) { sum.add(other); });
}

/// The least of the values of all ranks. All call it.
inline double least_over_ranks(Ranks& ranks, double value) {
  add_up_over_ranks(ranks, std::span(&value, 1), [](double& least, double other) { least = std::min(least, other); });
  return value;
}

}  // namespace gridlock
