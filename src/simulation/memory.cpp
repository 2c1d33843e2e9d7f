#include "simulation/memory.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <string>

#include "core/resources.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// The most that a run holds for each disk, and what a checkpoint adds to that: measured as the peak of `gridlock run` with
/// 10⁶ disks, docs/reference/performance.md, without the 15 MB of the program.
struct BytesPerDisk {
  double of_run;
  double of_checkpoint;
};
constexpr BytesPerDisk bytes_of_stepped{.of_run = 223.0, .of_checkpoint = 0.0};
constexpr BytesPerDisk bytes_of_tiled{.of_run = 232.0, .of_checkpoint = 19.0};
constexpr BytesPerDisk bytes_of_exact{.of_run = 320.0, .of_checkpoint = 139.0};
constexpr double bytes_per_agent_of_model = 250.0;
constexpr double bytes_per_cell = 4.0;
constexpr double bytes_per_row = 25 * 8.0;

/// What the machine has free, in bytes.
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

/// What the process may still ask for under its limit of address space, in bytes.
double free_memory_of_process() {
  rlimit limit{};
  std::ifstream file("/proc/self/statm");
  double pages = 0.0;
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || !(file >> pages)) {
    return std::numeric_limits<double>::infinity();
  }
  return std::max(0.0, static_cast<double>(limit.rlim_cur) - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

struct Demand {
  std::string what;
  std::string key;
  double bytes;
  char const* hint;
};

double bytes_per_disk(Configuration const& configuration) {
  std::string const& engine = configuration.engine.kind;
  BytesPerDisk const& bytes = engine == "exact"   ? bytes_of_exact
                              : engine == "tiled" ? bytes_of_tiled
                                                  : bytes_of_stepped;
  CheckpointSettings const& checkpoint = configuration.checkpoint;
  bool const has_checkpoints = checkpoint.every_seconds > 0.0 || checkpoint.every_steps > 0 || checkpoint.keep_last;
  return bytes.of_run + (has_checkpoints ? bytes.of_checkpoint : 0.0);
}

std::array<Demand, 3> demands_of(Configuration const& configuration) {
  auto const disks = static_cast<double>(configuration.disks.count.value_or(0));
  auto const cells = static_cast<double>(configuration.engine.cells.value_or(0));
  // Where another length ends the run, most of the steps may never come.
  bool const is_as_long = !configuration.run.time && !configuration.run.collisions_per_disk;
  std::uint64_t const steps = is_as_long ? configuration.run.steps.value_or(0) : 0;
  std::uint64_t const samples = steps / std::max<std::uint64_t>(1, configuration.observe.every);
  auto const rows = static_cast<double>(samples);
  return {Demand{fmt::format("{:.0f} disks", disks), "disks.count", bytes_per_disk(configuration) * disks,
                 "use fewer disks"},
          Demand{fmt::format("a grid of {0:.0f} × {0:.0f} cells", cells), "engine.cells",
                 bytes_per_cell * cells * cells, "leave engine.cells out, or use fewer"},
          Demand{fmt::format("a series of {:.0f} samples", rows), "observe.every", bytes_per_row * rows,
                 "use a larger observe.every, or fewer run.steps"}};
}

void require_free(Demand const& demand) {
  double const available = free_memory();
  if (demand.bytes <= available) return;
  throw Error({.what = fmt::format("{} would need about {:.3g} GB of memory, but {:.3g} GB are free", demand.what,
                                   demand.bytes / 1e9, available / 1e9),
               .hint = demand.hint,
               .key = demand.key});
}

}  // namespace

double free_memory() { return std::min({free_memory_of_machine(), free_memory_of_process(), granted_memory()}); }

double expected_memory(Configuration const& configuration, double agents) {
  double bytes = bytes_per_agent_of_model * agents;
  for (Demand const& demand : demands_of(configuration)) bytes += demand.bytes;
  return bytes;
}

void require_memory(Configuration const& configuration) {
  std::array<Demand, 3> const demands = demands_of(configuration);
  require_free(*std::ranges::max_element(demands, {}, &Demand::bytes));
}

void require_memory_for_agents(double agents, double bytes_per_agent, std::string const& key) {
  require_free({fmt::format("{:.0f} agents", agents), key, bytes_per_agent * agents, "use fewer agents"});
}

void MemoryBudget::take(double bytes) {
  std::unique_lock lock(mutex_);
  // Alone a run may take more than there is: whether it can be made at all is not asked here.
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
