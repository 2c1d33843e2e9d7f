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

  void sum(std::span<ExactSum> sums) const;
  void sum(std::span<std::uint64_t> counts) const;
  [[nodiscard]] double min(double value) const;

  /// Process after process changes one value of all in their order, and all get the result: so sums over rows in their
  /// order have the bits of one process. change(value) works on it in place.
  template <class Value, class Change>
  [[nodiscard]] Value change_in_order(Value value, Change change) const {
    static_assert(std::is_trivially_copyable_v<Value>);
    take_turns(std::as_writable_bytes(std::span(&value, 1)), [&] { change(value); });
    return value;
  }

  [[nodiscard]] Communicator& communicator() const { return *communicator_; }

 private:
  void take_turns(std::span<std::byte> value, std::function<void()> const& change) const;

  Communicator* communicator_;
};

}  // namespace gridlock
