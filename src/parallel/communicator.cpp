#include "gridlock/parallel/communicator.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// The communicator of a process that is alone: it sends nothing.
class Alone final : public Communicator {
 public:
  [[nodiscard]] std::size_t rank() const override { return 0; }
  [[nodiscard]] std::size_t count() const override { return 1; }
  void send(std::size_t /*to*/, Message /*message*/) override { std::abort(); }
  Message receive(std::size_t /*from*/) override { std::abort(); }
  [[nodiscard]] Traffic traffic() const override { return {}; }
  [[nodiscard]] double seconds() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  [[nodiscard]] std::size_t count_on_machine() const override { return 1; }
  [[nodiscard]] bool is_stop_asked() const override { return false; }
  void ask_to_stop() override {}
  [[noreturn]] void abandon(std::string const& /*why*/) override { std::abort(); }
};

/// Returns a message that contains messages one after the other, each behind its length.
Message bundle_of(std::span<Message const> messages) {
  MessageWriter bundle;
  for (Message const& message : messages) {
    bundle.add(std::uint64_t{message.size()});
    bundle.add_all(std::span(message));
  }
  return bundle.take();
}

std::vector<Message> messages_in(Message const& bundle) {
  std::vector<Message> messages;
  MessageReader reader(bundle);
  while (!reader.is_at_end()) messages.push_back(reader.next_values<std::byte>(reader.next<std::uint64_t>()));
  return messages;
}

}  // namespace

Communicator& Communicator::alone() {
  static Alone alone;
  return alone;
}

/// Ranks form a circle. Each rank knows the messages of itself and of some ranks that follow it, and every round
/// doubles their number.
/// Source: J. Bruck et al., Efficient algorithms for all-to-all communications in multiport message-passing systems
/// (1997), doi:10.1109/71.642949.
std::vector<Message> all_gather(Communicator& ranks, Message own) {
  std::size_t const all = ranks.count();
  std::size_t const rank = ranks.rank();
  std::vector<Message> known;
  known.reserve(all);
  known.push_back(std::move(own));
  while (known.size() < all) {
    std::size_t const distance = known.size();
    ranks.send((rank + all - distance) % all, bundle_of(std::span(known).first(std::min(distance, all - distance))));
    std::ranges::move(messages_in(ranks.receive((rank + distance) % all)), std::back_inserter(known));
  }
  std::rotate(known.begin(), known.begin() + static_cast<std::ptrdiff_t>((all - rank) % all), known.end());
  return known;
}

Message broadcast(Communicator& ranks, Message of_root) {
  std::size_t const rank = ranks.rank();
  std::size_t step = 1;
  while (step < ranks.count() && (rank & step) == 0) step *= 2;
  if (rank != 0) of_root = ranks.receive(rank - step);
  while (step > 1) {
    step /= 2;
    if (rank + step < ranks.count()) ranks.send(rank + step, of_root);
  }
  return of_root;
}

std::vector<Message> gather(Communicator& ranks, Message own) {
  if (ranks.count() == 1) return {std::move(own)};
  Message const bundle = reduce(ranks, bundle_of(std::span(&own, 1)), [](Message left, Message const& right) {
    left.insert(left.end(), right.begin(), right.end());
    return left;
  });
  return messages_in(bundle);
}

}  // namespace gridlock
