#pragma once

// Functions that all ranks of a communicator call together, in the same order. With one rank they send nothing.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// Returns the messages of all ranks, by rank, on all ranks. Each rank sends and receives ⌈log₂ ranks⌉ messages.
[[nodiscard]] std::vector<Message> all_gather(Communicator& ranks, Message own);

/// Merges the messages of all ranks. Returns the result on the root, and an empty message on other ranks. In a tree,
/// rank r receives the merged messages of ranks r + 1, r + 2, r + 4 … and sends its own to rank r without its lowest
/// bit: no rank receives more than ⌈log₂ ranks⌉ messages. merge(left, right) returns two messages as one; the ranks of
/// `right` follow those of `left`.
///
///     0 ◄─ 1    2 ◄─ 3        0 ◄─ 2        0 ◄─ 4
template <class Merge>
Message reduce(Communicator& ranks, Message own, Merge merge) {
  std::size_t const rank = ranks.rank();
  for (std::size_t step = 1; step < ranks.count(); step *= 2) {
    if ((rank & step) != 0) {
      ranks.send(rank - step, std::move(own));
      return {};
    }
    if (rank + step < ranks.count()) own = merge(std::move(own), ranks.receive(rank + step));
  }
  return own;
}

/// Returns the message of the root on all ranks, sent along the tree of reduce(). The messages of other ranks are
/// ignored.
[[nodiscard]] Message broadcast(Communicator& ranks, Message of_root);

/// Returns the messages of all ranks, by rank, on the root, and nothing on other ranks; sent along the tree of
/// reduce().
[[nodiscard]] std::vector<Message> gather(Communicator& ranks, Message own);

/// Merges the messages of all ranks, and returns the result on all ranks.
template <class Merge>
Message all_reduce(Communicator& ranks, Message own, Merge merge) {
  return broadcast(ranks, reduce(ranks, std::move(own), merge));
}

/// Combines numbers[k] of all ranks by combine(number, other), for each k; all ranks get the results.
template <class Number, class Combine>
void all_combine(Communicator& ranks, std::span<Number> numbers, Combine combine) {
  if (ranks.count() == 1 || numbers.empty()) return;
  Message const all = all_reduce(ranks, message_of_all(std::span<Number const>(numbers)),
                                 [&](Message const& left, Message const& right) {
                                   auto combined = MessageReader(left).next_values<Number>(numbers.size());
                                   auto const others = MessageReader(right).next_values<Number>(numbers.size());
                                   for (std::size_t k = 0; k < combined.size(); ++k) combine(combined[k], others[k]);
                                   return message_of_all(std::span<Number const>(combined));
                                 });
  MessageReader(all).read_into(numbers);
}

/// Replace each number by its sum over all ranks.
inline void all_sum(Communicator& ranks, std::span<std::uint64_t> counts) {
  all_combine(ranks, counts, [](std::uint64_t& sum, std::uint64_t other) { sum += other; });
}
inline void all_sum(Communicator& ranks, std::span<ExactSum> sums) {
  all_combine(ranks, sums, [](ExactSum& sum, ExactSum const& other) { sum.add(other); });
}
inline std::uint64_t all_sum(Communicator& ranks, std::uint64_t own) {
  all_sum(ranks, std::span(&own, 1));
  return own;
}

/// Return the minimum and the maximum of the numbers of all ranks.
template <class Number>
Number all_min(Communicator& ranks, Number own) {
  all_combine(ranks, std::span(&own, 1), [](Number& min, Number other) { min = std::min(min, other); });
  return own;
}
template <class Number>
Number all_max(Communicator& ranks, Number own) {
  all_combine(ranks, std::span(&own, 1), [](Number& max, Number other) { max = std::max(max, other); });
  return own;
}

/// Returns the largest power of two that is not above the largest key of all ranks; 0 if that key is 0.
inline std::uint64_t highest_bit_of_all(Communicator& ranks, std::uint64_t max_own) {
  return std::bit_floor(all_max(ranks, max_own));
}

}  // namespace gridlock
