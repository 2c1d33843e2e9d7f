#include "gridlock/parallel/detail/all_processes.hpp"

#include <algorithm>

#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

AllProcesses::AllProcesses() : AllProcesses(Communicator::alone()) {}

std::size_t AllProcesses::rank() const { return communicator_->rank(); }

std::size_t AllProcesses::count() const { return communicator_->count(); }

void AllProcesses::sum(std::span<ExactSum> sums) const { all_sum(*communicator_, sums); }

void AllProcesses::sum(std::span<std::uint64_t> counts) const { all_sum(*communicator_, counts); }

double AllProcesses::min(double value) const { return all_min(*communicator_, value); }

void AllProcesses::agree(std::function<void()> const& work) const { gridlock::agree(*communicator_, work); }

void AllProcesses::on_root(std::function<void()> const& work) const { gridlock::on_root(*communicator_, work); }

void AllProcesses::require_failure_of_all(char const* why) const {
  if (count() > 1 && !communicator_->have_all_failed()) communicator_->abandon(why);
}

void AllProcesses::broadcast(std::span<std::byte> value) const {
  if (count() == 1) return;
  std::ranges::copy(gridlock::broadcast(*communicator_, Message(value.begin(), value.end())), value.begin());
}

void AllProcesses::take_turns(std::span<std::byte> value, std::function<void()> const& change) const {
  Communicator& ranks = *communicator_;
  std::size_t const rank = ranks.rank();
  std::size_t const last = ranks.count() - 1;
  auto const take = [&](std::size_t from) { std::ranges::copy(ranks.receive(from), value.begin()); };
  auto const give = [&](std::size_t to) { ranks.send(to, Message(value.begin(), value.end())); };
  if (rank > 0) take(rank - 1);
  change();
  if (rank < last) {
    give(rank + 1);
    take(last);
  } else {
    for (std::size_t to = 0; to < last; ++to) give(to);
  }
}

}  // namespace gridlock
