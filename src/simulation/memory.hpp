#pragma once

#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// Refuses a run that needs more memory than the machine has free, before any of it is asked for: a system short of
/// memory kills the program, which leaves no message and no results.
///
/// Counts what can become large: the agents, the cells of the grid, the rows of the series. Of agents that
/// processes share those on this machine count. An estimate, on the low side.
void require_memory(Configuration const& configuration, AllProcesses processes);

/// The bytes a run needs by the same estimate; more closely where it is known how many agents there are.
double expected_memory(Configuration const& configuration);
double expected_memory(Configuration const& configuration, std::size_t agents);

/// The memory that the program can still get, in bytes: of the machine, under the limit of the process (ulimit -v), and
/// under those of its control groups, such as a container's.
double free_memory();

/// Memory that several runs share: those that do not fit beside one another wait for one another.
class MemoryBudget {
 public:
  explicit MemoryBudget(double bytes) : bytes_(bytes) {}

  /// A part of the budget for as long as it lives.
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
