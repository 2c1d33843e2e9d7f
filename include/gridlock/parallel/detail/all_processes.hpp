#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>

#include "gridlock/core/detail/exact_sum.hpp"

namespace gridlock {

class Communicator;

/// Makes sums and minima over the agents of one process those over the agents of all that share its run. All of them
/// call each function, in the same order.
/// Cost: nothing where the process is alone; else a few short messages.
class AllProcesses {
 public:
  /// This process alone.
  AllProcesses();
  /// All processes of a communicator, which is converted wherever they are asked for.
  AllProcesses(Communicator& communicator) : communicator_(&communicator) {}

  /// The number of this process.
  [[nodiscard]] std::size_t rank() const;
  /// The number of processes that share the run.
  [[nodiscard]] std::size_t count() const;
  /// Whether this process is the root: the one that reads and writes files and talks to the user.
  [[nodiscard]] bool is_root() const { return rank() == 0; }

  void sum(std::span<ExactSum> sums) const;
  void sum(std::span<std::uint64_t> counts) const;
  [[nodiscard]] std::uint64_t sum(std::uint64_t count) const {
    sum(std::span(&count, 1));
    return count;
  }
  [[nodiscard]] double min(double value) const;

  /// Process after process changes one value of all in their order, and all get the result: so sums over rows in their
  /// order have the bits of one process. change(value) works on it in place.
  template <class Value, class Change>
  [[nodiscard]] Value change_in_order(Value value, Change change) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    take_turns(std::as_writable_bytes(std::span(&value, 1)), [&] { change(value); });
    return value;
  }

  /// The value of the root, in all processes.
  template <class Value>
  [[nodiscard]] Value of_root(Value value) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    broadcast(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }

  /// Does some work in all processes: where it fails in one, all fail alike, see parallel/detail/agreement.hpp.
  void agree(std::function<void()> const& work) const;
  /// The same with work of the root alone.
  void on_root(std::function<void()> const& work) const;

  /// Ends all processes where this one has failed alone and others wait for it.
  void require_failure_of_all(char const* why) const;

  [[nodiscard]] Communicator& communicator() const { return *communicator_; }

 private:
  void broadcast(std::span<std::byte> value) const;
  void take_turns(std::span<std::byte> value, std::function<void()> const& change) const;

  Communicator* communicator_;
};

}  // namespace gridlock
