#pragma once

/// \file
/// The processes that share a run.
///
/// ```cpp
/// Communicator& alone = Communicator::alone();
/// std::vector<std::size_t> own_parts(alone.count());  // one, for this process is the only one
/// own_parts[alone.rank()] = 1000;
/// ```

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/detail/message.hpp"

namespace gridlock {

/// The number and size of the messages that a rank has sent, and the time for which it has waited for other ranks.
struct Traffic {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  double seconds_waiting = 0.0;
};

/// The processes that share one run, its ranks. In each process only one thread calls these functions. Messages from
/// one rank to another arrive in the order in which they were sent.
class Communicator {
 public:
  /// Returns the communicator of a process that does not share its run.
  static Communicator& alone();

  Communicator() = default;
  Communicator(Communicator const&) = delete;
  Communicator& operator=(Communicator const&) = delete;
  virtual ~Communicator() = default;

  /// Returns the number of this process; 0 is the root.
  [[nodiscard]] virtual std::size_t rank() const = 0;
  [[nodiscard]] virtual std::size_t count() const = 0;
  /// Sends a message to a rank, without waiting for its arrival.
  virtual void send(std::size_t to, Message message) = 0;
  /// Waits for the next message from a rank, and returns it.
  virtual Message receive(std::size_t from) = 0;

  [[nodiscard]] virtual Traffic traffic() const = 0;
  /// Returns the seconds since a fixed time.
  [[nodiscard]] virtual double seconds() const = 0;
  /// Returns the number of ranks on the machine of this rank, itself included.
  [[nodiscard]] virtual std::size_t count_on_machine() const = 0;
  /// Called after agents of this rank have taken `turns` turns, so that a simulated cluster can estimate the time of
  /// computation.
  virtual void note_turns(std::uint64_t /*turns*/) {}
  /// Returns whether this process has been asked to stop.
  [[nodiscard]] virtual bool is_stop_asked() const = 0;
  /// Called when another rank has been asked to stop.
  virtual void ask_to_stop() = 0;
  /// Ends all ranks, since this rank cannot continue and other ranks wait for its messages.
  [[noreturn]] virtual void abandon(std::string const& why) = 0;

  /// Returns whether all ranks failed together in their last agree(): then no rank waits for another.
  [[nodiscard]] bool have_all_failed() const { return have_all_failed_; }
  void note_agreement(bool have_all_failed) { have_all_failed_ = have_all_failed; }

  /// Returns, on the root, the traffic of each rank at the end of the last advance(); empty for a process that does not
  /// share its run.
  [[nodiscard]] std::vector<Traffic> const& traffic_of_ranks() const { return traffic_of_ranks_; }
  void note_traffic(std::size_t rank, Traffic const& traffic) {
    if (traffic_of_ranks_.size() <= rank) traffic_of_ranks_.resize(rank + 1);
    traffic_of_ranks_[rank] = traffic;
  }

 private:
  bool have_all_failed_ = false;
  std::vector<Traffic> traffic_of_ranks_;
};

}  // namespace gridlock
