#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// Sends values between ranks. All ranks call it, each with `count` values: give_one(k, give) calls give(rank, value)
/// for value k, once for each rank that shall have it, and take(value) is called for each value that arrives from any
/// rank, this one included. Values go in rounds, so that messages stay short, and no two ranks wait for each other to
/// receive.
template <class Value, class GiveOne, class Take>
void exchange_values(Communicator& ranks, std::size_t count, GiveOne give_one, Take take) {
  constexpr std::size_t numbers_of_round = std::size_t{1} << 16;
  std::size_t const self = ranks.rank();
  std::vector<std::vector<Value>> leaving(ranks.count());
  auto const give = [&](std::size_t rank, Value const& value) {
    rank == self ? take(value) : leaving[rank].push_back(value);
  };
  std::vector<bool> is_done(ranks.count(), false);
  std::size_t next = 0;
  for (std::size_t sending = ranks.count(); sending > 0;) {
    if (!is_done[self]) {
      std::size_t const end = std::min(count, next + numbers_of_round);
      for (; next < end; ++next) give_one(next, give);
      is_done[self] = next == count;
      for (std::size_t rank = 0; rank < ranks.count(); ++rank) {
        if (rank == self) continue;
        MessageWriter message;
        message.add(std::uint64_t{is_done[self] ? 1U : 0U});
        message.add_all(std::span<Value const>(leaving[rank]));
        ranks.send(rank, message.take());
        leaving[rank].clear();
      }
      if (is_done[self]) --sending;
    }
    for (std::size_t rank = 0; rank < ranks.count(); ++rank) {
      if (rank == self || is_done[rank]) continue;
      Message const bytes = ranks.receive(rank);
      MessageReader message(bytes);
      is_done[rank] = message.next<std::uint64_t>() != 0;
      for (Value const& value : message.rest<Value>()) take(value);
      if (is_done[rank]) --sending;
    }
  }
}

}  // namespace gridlock
