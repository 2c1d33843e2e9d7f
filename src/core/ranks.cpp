#include "gridlock/core/detail/ranks.hpp"

#include <algorithm>
#include <iterator>

namespace gridlock {

namespace {

/// Messages one after the other, each after its length.
Ranks::Bytes bundle_of(std::span<Ranks::Bytes const> messages) {
  MessageWriter bundle;
  for (Ranks::Bytes const& message : messages) {
    bundle.add(std::uint64_t{message.size()});
    bundle.add_all(std::span(message));
  }
  return bundle.take();
}

std::vector<Ranks::Bytes> messages_in(Ranks::Bytes const& bundle) {
  std::vector<Ranks::Bytes> messages;
  MessageReader reader(bundle);
  while (!reader.is_at_end()) messages.push_back(reader.next_values<std::byte>(reader.next<std::uint64_t>()));
  return messages;
}

}  // namespace

/// Each rank knows of itself and of as many that follow it as it has heard of, around the circle of ranks, and every message doubles them.
/// Source: J. Bruck et al., Efficient algorithms for all-to-all communications in multiport message-passing systems (1997),
/// doi:10.1109/71.642949.
std::vector<Ranks::Bytes> Ranks::gather_for_all(Bytes own) {
  std::size_t const all = count();
  std::vector<Bytes> known;
  known.reserve(all);
  known.push_back(std::move(own));
  while (known.size() < all) {
    std::size_t const distance = known.size();
    send((rank() + all - distance) % all, bundle_of(std::span(known).first(std::min(distance, all - distance))));
    std::ranges::move(messages_in(receive((rank() + distance) % all)), std::back_inserter(known));
  }
  std::rotate(known.begin(), known.begin() + static_cast<std::ptrdiff_t>((all - rank()) % all), known.end());
  return known;
}

Ranks::Bytes hand_down(Ranks& ranks, Ranks::Bytes of_leader) {
  std::size_t const rank = ranks.rank();
  std::size_t step = 1;
  while (step < ranks.count() && (rank & step) == 0) step *= 2;
  if (rank != 0) of_leader = ranks.receive(rank - step);
  while (step > 1) {
    step /= 2;
    if (rank + step < ranks.count()) ranks.send(rank + step, of_leader);
  }
  return of_leader;
}

std::vector<Ranks::Bytes> gather_for_leader(Ranks& ranks, Ranks::Bytes own) {
  Ranks::Bytes const bundle =
      merge_for_leader(ranks, bundle_of(std::span(&own, 1)), [](Ranks::Bytes left, Ranks::Bytes const& right) {
        left.insert(left.end(), right.begin(), right.end());
        return left;
      });
  return messages_in(bundle);
}

}  // namespace gridlock
