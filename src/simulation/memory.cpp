#include "simulation/memory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "core/resources.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "io/posix.hpp"

namespace gridlock {

namespace {

constexpr double bytes_per_row = 25 * 8.0;

/// Returns the free memory of the machine in bytes.
double free_memory_of_machine() {
  std::ifstream file("/proc/meminfo");
  for (std::string word; file >> word;) {
    double kibibytes = 0.0;
    if (word == "MemAvailable:" && file >> kibibytes) return 1024.0 * kibibytes;
  }
  long const pages = sysconf(_SC_PHYS_PAGES);
  long const page_size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || page_size <= 0) return std::numeric_limits<double>::infinity();
  return static_cast<double>(pages) * static_cast<double>(page_size);
}

/// Returns how many bytes the process may still allocate under its limit of address space.
double free_memory_of_process() {
  rlimit limit{};
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || !(file >> pages)) {
    return std::numeric_limits<double>::infinity();
  }
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

/// Returns the memory for the rows of the series.
MemoryDemand series_of(Configuration const& configuration) {
  // If a time or collisions may end the run earlier, most of run.steps may never be reached.
  bool const is_as_long = !configuration.run.time && !configuration.run.collisions_per_disk;
  std::uint64_t const steps = is_as_long ? configuration.run.steps.value_or(0) : 0;
  ObserveSettings const& observe = configuration.observe;
  double const even =
      std::floor(static_cast<double>(steps) / static_cast<double>(std::max<std::uint64_t>(1, observe.every)));
  double const rows = observe.per_decade == 0 ? even : static_cast<double>(observe.per_decade) * std::log10(even + 1.0);
  return {fmt::format("a series of {:.0f} samples", rows), "observe.every", bytes_per_row * rows,
          "use a larger observe.every, or fewer run.steps"};
}

void require_free(MemoryDemand const& demand) {
  double const available = free_memory();
  if (demand.bytes <= available) return;
  throw Error({.what = fmt::format("{} would need about {:.3g} GB of memory, but {:.3g} GB are free", demand.what,
                                   demand.bytes / 1e9, available / 1e9),
               .hint = demand.hint,
               .key = demand.key});
}

}  // namespace

double free_memory() { return std::min({free_memory_of_machine(), free_memory_of_process(), granted_memory()}); }

double expected_memory(Configuration const& configuration) {
  double bytes = series_of(configuration).bytes;
  for (MemoryDemand const& demand : configuration.kind().memory(configuration)) bytes += demand.bytes;
  return bytes;
}

double expected_memory(Configuration const& configuration, std::size_t agents) {
  return series_of(configuration).bytes + configuration.kind().expected_bytes(configuration, agents);
}

void require_memory(Configuration const& configuration, AllProcesses processes) {
  std::vector<MemoryDemand> demands = configuration.kind().memory(configuration);
  Communicator const& communicator = processes.communicator();
  double const share = static_cast<double>(communicator.count_on_machine()) / static_cast<double>(communicator.count());
  for (MemoryDemand& demand : demands) demand.bytes *= std::min(1.0, share);
  demands.push_back(series_of(configuration));
  require_free(*std::ranges::max_element(demands, {}, &MemoryDemand::bytes));
}

void MemoryBudget::take(double bytes) {
  std::unique_lock lock(mutex_);
  // A single run may exceed the budget, since require_memory() decides whether it is possible at all.
  is_given_back_.wait(lock, [&] { return parts_ == 0 || taken_ + bytes <= bytes_; });
  taken_ += bytes;
  ++parts_;
}

void MemoryBudget::give_back(double bytes) {
  {
    std::scoped_lock const lock(mutex_);
    --parts_;
    taken_ = parts_ == 0 ? 0.0 : taken_ - bytes;
  }
  is_given_back_.notify_all();
}

}  // namespace gridlock
