#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// Throws an Error before a run allocates more memory than the machine has free. Otherwise the system would kill the
/// program, without a message or results.
///
/// Estimates the parts that can become large, on the low side: agents, cells of the grid, rows of the series. For a run
/// on several processes it counts the agents of the processes on this machine.
void require_memory(Configuration const& configuration, AllProcesses processes);

/// Returns the estimate of require_memory() in bytes; it is more accurate if the number of agents is known.
double expected_memory(Configuration const& configuration);
double expected_memory(Configuration const& configuration, std::size_t agents);

/// Returns the memory in bytes that the program can still get: the least of the free memory of the machine, the limit
/// of the process (ulimit -v) and the limits of its control groups, such as a container's.
double free_memory();

/// Memory that several runs share. A run whose part does not fit waits until other runs end.
class MemoryBudget {
 public:
  explicit MemoryBudget(double bytes) : bytes_(bytes) {}

  /// A part of the budget, reserved for the lifetime of this object.
  class Part {
   public:
    Part(MemoryBudget& budget, double bytes) : budget_(budget), bytes_(bytes) { budget_.take(bytes_); }
    ~Part() { budget_.give_back(bytes_); }
    Part(Part const&) = delete;
    Part& operator=(Part const&) = delete;

   private:
    MemoryBudget& budget_;
    double bytes_;
  };

 private:
  void take(double bytes);
  void give_back(double bytes);

  double bytes_;
  double taken_ = 0.0;
  std::size_t parts_ = 0;
  std::mutex mutex_;
  std::condition_variable is_given_back_;
};

}  // namespace gridlock
