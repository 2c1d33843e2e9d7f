#pragma once

#include <cstdint>
#include <exception>
#include <new>
#include <string>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// What the root asks all others for: the first number of a message.
enum class TaskOfRanks : std::uint64_t {
  leave,
  steps_of_disks,
  // Of a run whose agents are divided.
  begin_run,
  observe_run,
  sample_run,
  hash_run,
  steps_from_homes,
  find_patience,
  arrange_frame,
  give_rows,
  forget_frame,
  write_rows,
  restore_rows,
  forget_run,
};

inline void send_to_others(Communicator& ranks, Message const& message) {
  for (std::size_t rank = 1; rank < ranks.count(); ++rank) ranks.send(rank, message);
}

/// The root says what is to be done before it does its own part of it.
inline void send_task(Communicator& ranks, TaskOfRanks task) { send_to_others(ranks, message_of(task)); }
template <class Order>
void send_task(Communicator& ranks, TaskOfRanks task, Order const& order) {
  MessageWriter message;
  message.add(task);
  message.add(order);
  send_to_others(ranks, message.take());
}
inline void send_task(Communicator& ranks, TaskOfRanks task, std::string const& text) {
  MessageWriter message;
  message.add(task);
  message.add_text(text);
  send_to_others(ranks, message.take());
}

/// The root lets all others go, who wait for what it asks of them.
inline void release_helpers(Communicator& ranks) { send_to_others(ranks, message_of(TaskOfRanks::leave)); }

/// Others wait for a rank that fails here: they end with it.
template <class Work>
void do_or_abandon(Communicator& ranks, Work work) {
  try {
    work();
  } catch (std::bad_alloc const&) {
    ranks.abandon("not enough memory");
  } catch (std::exception const& error) {
    ranks.abandon(error.what());
  }
}

/// How many steps the root lets all take before it looks up: for about 20 ms.
class StepsBetweenLooks {
 public:
  explicit StepsBetweenLooks(Communicator const& ranks) : ranks_(ranks) {}

  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  void begin() { begin_ = ranks_.seconds(); }
  void end(std::uint64_t steps_done) {
    constexpr double seconds_between_looks = 0.02;
    double const seconds = ranks_.seconds() - begin_;
    double const fitting = seconds_between_looks * static_cast<double>(steps_done) / (seconds + 1e-9);
    steps_ = static_cast<std::uint64_t>(fitting < 1.0 ? 1.0 : fitting > 100.0 ? 100.0 : fitting);
  }

 private:
  Communicator const& ranks_;
  std::uint64_t steps_ = 1;
  double begin_ = 0.0;
};

}  // namespace gridlock
