#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

#include "gridlock/core/detail/exact_sum.hpp"

namespace gridlock {

class Communicator;

/// Combines sums and minima over the agents of one process to sums and minima over the agents of all processes of a
/// run. All processes call each function, in the same order.
/// Cost: nothing for a run of one process; else a few short messages.
class AllProcesses {
 public:
  /// Makes the processes of a run that this process does not share.
  AllProcesses();
  /// All processes of a communicator; a communicator converts to it.
  AllProcesses(Communicator& communicator) : communicator_(&communicator) {}

  [[nodiscard]] std::size_t rank() const;
  [[nodiscard]] std::size_t count() const;
  /// Returns whether this process is the root, which reads and writes files and prints messages to the user.
  [[nodiscard]] bool is_root() const { return rank() == 0; }

  void sum(std::span<ExactSum> sums) const;
  void sum(std::span<std::uint64_t> counts) const;
  [[nodiscard]] std::uint64_t sum(std::uint64_t count) const {
    sum(std::span(&count, 1));
    return count;
  }
  [[nodiscard]] double min(double value) const;

  /// Calls change(value) in one process after the other, each with the value that the last one left, and returns the
  /// result in all processes. So a sum over rows in their order has the bits of a run of one process.
  template <class Value, class Change>
  [[nodiscard]] Value change_in_order(Value value, Change change) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    take_turns(std::as_writable_bytes(std::span(&value, 1)), [&] { change(value); });
    return value;
  }

  /// Returns the value of the root in all processes.
  template <class Value>
  [[nodiscard]] Value of_root(Value value) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    broadcast(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  /// Does work in all processes; if it fails in one process, all throw its error, see parallel/detail/agreement.hpp.
  void agree(std::function<void()> const& work) const;
  /// Does work in the root only; if it fails, all processes throw its error.
  void on_root(std::function<void()> const& work) const;

  /// Ends all processes if this process has failed alone, since the others wait for it.
  void require_failure_of_all(char const* why) const;

  [[nodiscard]] Communicator& communicator() const { return *communicator_; }

 private:
  void broadcast(std::span<std::byte> value) const;
  void take_turns(std::span<std::byte> value, std::function<void()> const& change) const;

  Communicator* communicator_;
};

}  // namespace gridlock
