#include "run/memory.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <string>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

// Measured at 10⁶ disks: 250 bytes a disk for the stepped engine, 390 for the exact one.
constexpr double bytes_per_disk = 250.0;
constexpr double bytes_per_cell = 4.0;
constexpr double bytes_per_row = 25 * 8.0;

/// What the system says programs can still get, in bytes.
double free_memory() {
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

struct Demand {
  std::string what;
  char const* key;
  double bytes;
  char const* hint;
};

}  // namespace

void require_memory(Configuration const& configuration) {
  auto const disks = static_cast<double>(configuration.disks.count.value_or(0));
  auto const cells = static_cast<double>(configuration.engine.cells.value_or(0));
  std::uint64_t const samples =
      configuration.run.steps.value_or(0) / std::max<std::uint64_t>(1, configuration.observe.every);
  auto const rows = static_cast<double>(samples);
  std::array<Demand, 3> const demands{
      Demand{fmt::format("{:.0f} disks", disks), "disks.count", bytes_per_disk * disks, "use fewer disks"},
      Demand{fmt::format("a grid of {0:.0f} × {0:.0f} cells", cells), "engine.cells", bytes_per_cell * cells * cells,
             "leave engine.cells out, or use fewer"},
      Demand{fmt::format("a series of {:.0f} samples", rows), "observe.every", bytes_per_row * rows,
             "use a larger observe.every, or fewer run.steps"}};
  Demand const& largest = *std::ranges::max_element(demands, {}, &Demand::bytes);
  double const available = free_memory();
  if (largest.bytes <= available) return;
  throw Error({.what = fmt::format("{} would need about {:.3g} GB of memory, but {:.3g} GB are free", largest.what,
                                   largest.bytes / 1e9, available / 1e9),
               .hint = largest.hint,
               .key = largest.key});
}

}  // namespace gridlock
