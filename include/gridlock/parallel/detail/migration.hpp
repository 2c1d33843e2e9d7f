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

/// Rows of agents between two steps: which processes have to know each, and which do not stay here.
///
/// Neighbours of a Domain always send each other a message. A row for a process that is none has to be announced:
/// find_far() here, and is_far() among what the others have announced.
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
  /// A row does not stay.
  void drop(std::uint32_t row) { dropped_.push_back(row); }
  /// Notes which processes have to know an agent at a point that this process has, and whether it stays. One that
  /// belongs to another process, but lies in the rim of this one, stays to be seen.
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
  /// The first `rows` rows for which is_dead(row) neither stay nor go anywhere.
  template <class IsDead>
  void drop_dead(std::size_t rows, IsDead is_dead) {
    for (std::uint32_t row = 0; row < rows; ++row) {
      if (is_dead(row)) drop(row);
    }
    for (std::vector<std::uint32_t>& addressed : rows_to_) {
      std::erase_if(addressed, [&](std::uint32_t row) { return row < rows && is_dead(row); });
    }
  }

  /// The processes that are no neighbours and have to know some rows.
  std::span<std::uint64_t const> find_far(Domain const& domain) {
    far_.clear();
    for (std::size_t process = 0; process < rows_to_.size(); ++process) {
      if (!rows_to_[process].empty() && !domain.is_neighbour(process)) far_.push_back(process);
    }
    return far_;
  }

  /// Sends rows to those who have to know them, and takes what has come in the place of those that do not stay.
  /// `far` are the processes that are no neighbours and have announced some. All call it.
  void exchange(Domain const& domain, std::span<std::uint64_t const> far, LargeArray<Id>& ids, AllValues& values) {
    exchange_if([&](std::size_t to) { return domain.is_neighbour(to) || is_among(far_, to); },
                [&](std::size_t from) { return domain.is_neighbour(from) || is_among(far, from); }, domain.processes(),
                ids, values);
  }
  /// The same where every process sends a message to every other.
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
    // One round for each distance between processes: nobody waits to send before what came earlier has been received.
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

  std::vector<std::vector<std::uint32_t>> rows_to_;  ///< for each process
  std::vector<std::uint32_t> dropped_;
  std::vector<std::uint64_t> far_;
};

}  // namespace gridlock
