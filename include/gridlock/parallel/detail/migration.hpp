#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/parallel/detail/agents_message.hpp"
#include "gridlock/parallel/detail/domain.hpp"

namespace gridlock {

/// Sends agents to other processes between two steps: lists for each process the rows that it needs, and the rows to be
/// dropped here.
///
/// Neighbours of a Domain always send each other a message. To send rows to any other process, announce it by
/// find_far(), and pass to exchange() the processes that have announced rows for this one.
template <class Agents>
class Migration {
 public:
  using AllValues = typename Agents::AllValues;

  explicit Migration(Domain const& domain) : rows_to_(domain.processes().count()) {}

  void begin() {
    for (std::vector<std::uint32_t>& rows : rows_to_) rows.clear();
    dropped_.clear();
    far_.clear();
  }
  void drop(std::uint32_t row) { dropped_.push_back(row); }
  /// Lists the agent of a row at `p` for each process that sees the point, and drops the row unless this process sees
  /// it: in its rectangle or in its rim.
  void address(Domain const& domain, std::uint32_t row, Vector p) {
    bool stays = domain.is_own(p);
    domain.for_each_that_sees(p, [&](std::size_t process) {
      if (process == domain.processes().rank()) {
        stays = true;
      } else {
        rows_to_[process].push_back(row);
      }
    });
    if (!stays) drop(row);
  }
  /// Drops all of the first `rows` rows for which is_dead(row), and sends them to no process.
  template <class IsDead>
  void drop_dead(std::size_t rows, IsDead is_dead) {
    for (std::uint32_t row = 0; row < rows; ++row) {
      if (is_dead(row)) drop(row);
    }
    for (std::vector<std::uint32_t>& addressed : rows_to_) {
      std::erase_if(addressed, [&](std::uint32_t row) { return row < rows && is_dead(row); });
    }
  }

  /// Returns the processes that need rows but are no neighbours.
  std::span<std::uint64_t const> find_far(Domain const& domain) {
    far_.clear();
    for (std::size_t process = 0; process < rows_to_.size(); ++process) {
      if (!rows_to_[process].empty() && !domain.is_neighbour(process)) far_.push_back(process);
    }
    return far_;
  }

  /// Sends the listed rows, and replaces dropped rows by the agents that arrive. `far` are the processes that have
  /// announced rows for this one without being its neighbours. All processes call it.
  void exchange(Domain const& domain, std::span<std::uint64_t const> far, LargeArray<Id>& ids, AllValues& values) {
    exchange_if([&](std::size_t to) { return domain.is_neighbour(to) || is_among(far_, to); },
                [&](std::size_t from) { return domain.is_neighbour(from) || is_among(far, from); }, domain.processes(),
                ids, values);
  }
  /// Does the same as exchange(), but every process sends a message to every other; nothing needs to be announced.
  void exchange_with_all(Domain const& domain, LargeArray<Id>& ids, AllValues& values) {
    auto const always = [](std::size_t /*process*/) { return true; };
    exchange_if(always, always, domain.processes(), ids, values);
  }

 private:
  static bool is_among(std::span<std::uint64_t const> processes, std::size_t process) {
    return std::ranges::find(processes, process) != processes.end();
  }

  template <class SendsTo, class GetsFrom>
  void exchange_if(SendsTo sends_to, GetsFrom gets_from, Communicator& processes, LargeArray<Id>& ids,
                   AllValues& values) {
    ArrivedAgents<Agents> arrived;
    // One round for each distance between ranks, so that messages are received while others are still sent.
    std::size_t const count = processes.count();
    for (std::size_t distance = 1; distance < count; ++distance) {
      std::size_t const to = (processes.rank() + distance) % count;
      std::size_t const from = (processes.rank() + count - distance) % count;
      if (sends_to(to)) {
        MessageWriter message;
        message.add(std::uint64_t{rows_to_[to].size()});
        add_agents(message, ids.data(), values, rows_to_[to]);
        processes.send(to, message.take());
      }
      if (gets_from(from)) arrived.add(processes.receive(from));
    }
    std::ranges::sort(dropped_);
    dropped_.erase(std::unique(dropped_.begin(), dropped_.end()), dropped_.end());
    arrived.put_into(ids, values, dropped_);
    begin();
  }

  std::vector<std::vector<std::uint32_t>> rows_to_;  ///< the rows to send to each process
  std::vector<std::uint32_t> dropped_;
  std::vector<std::uint64_t> far_;
};

}  // namespace gridlock
