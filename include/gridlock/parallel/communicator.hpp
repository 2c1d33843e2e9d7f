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

/// The number and size of the messages that a rank has sent, and the time for which it has waited for others.
struct Traffic {
  std::uint64_t messages = 0;
  std::uint64_t bytes = 0;
  double seconds_waiting = 0.0;
};

/// The processes that share one run, its ranks. Every function is called from one thread of each; messages from one
/// rank to another arrive in the order in which they were sent.
class Communicator {
 public:
  /// The communicator of a process that shares its run with no other.
  static Communicator& alone();

  Communicator() = default;
  Communicator(Communicator const&) = delete;
  Communicator& operator=(Communicator const&) = delete;
  virtual ~Communicator() = default;

  /// The number of this process; 0 is the root.
  [[nodiscard]] virtual std::size_t rank() const = 0;
  [[nodiscard]] virtual std::size_t count() const = 0;
  /// Sends a message and does not wait until it has arrived.
  virtual void send(std::size_t to, Message message) = 0;
  /// Waits for the next message of a rank.
  virtual Message receive(std::size_t from) = 0;

  /// The traffic of this rank.
  [[nodiscard]] virtual Traffic traffic() const = 0;
  /// Seconds since some moment.
  [[nodiscard]] virtual double seconds() const = 0;
  /// The number of ranks on the machine of this one, itself included.
  [[nodiscard]] virtual std::size_t count_on_machine() const = 0;
  /// Agents have taken that many turns here: a simulator of clusters has to be told how much was computed.
  virtual void note_turns(std::uint64_t /*turns*/) {}
  /// Whether this process has been asked to stop.
  [[nodiscard]] virtual bool is_stop_asked() const = 0;
  /// Another rank has been asked to stop.
  virtual void ask_to_stop() = 0;
  /// Ends all ranks: this one cannot go on, and others wait for it.
  [[noreturn]] virtual void abandon(std::string const& why) = 0;

  /// Whether all ranks have failed alike when they last agreed, see agree(): then none of them waits for another.
  [[nodiscard]] bool have_all_failed() const { return have_all_failed_; }
  void note_agreement(bool have_all_failed) { have_all_failed_ = have_all_failed; }

  /// The traffic of each rank, as the root knows it from the end of the last steps that they took together; none of a
  /// process that is alone.
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
