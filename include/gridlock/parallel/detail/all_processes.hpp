#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridlock/core/detail/exact_sum.hpp"

namespace gridlock {

class Communicator;

/// Makes sums and minima over the agents of one process those over the agents of all that share its run. All of them call each function, in the
/// same order.
/// Cost: nothing where the process is alone; else a few short messages.
class AllProcesses {
 public:
  /// This process alone.
  AllProcesses();
  AllProcesses(Communicator& communicator) : communicator_(&communicator) {}  // NOLINT(google-explicit-constructor)

  /// The number of processes that share the run.
  [[nodiscard]] std::size_t count() const;

  void sum(std::span<ExactSum> sums) const;
  void sum(std::span<std::uint64_t> counts) const;
  [[nodiscard]] double min(double value) const;

  [[nodiscard]] Communicator& communicator() const { return *communicator_; }

 private:
  Communicator* communicator_;
};

}  // namespace gridlock
