// Disk-steps a second of one core: `tiled` beside LAMMPS' granular disks, the same numbers of disks at the same packing
// fraction, in turns in one run. Without LAMMPS (Debian: apt-get install lammps) there is nothing to compare with.
// To be run from the root of the repository. gridlock_bench_lammps SIDE runs SIDE × SIDE disks.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr double packing_fraction = 0.7;

/// Seconds LAMMPS says its last run took, processor time of one thread; 0 where it could not be run.
double lammps_seconds(std::size_t side, std::uint64_t steps, std::string const& skin) {
  std::string const command = "lmp -log none -in benchmarks/lammps_disks.in -var side " + std::to_string(side) +
                              " -var phi 0.7 -var mix 300 -var skin " + skin + " -var steps " + std::to_string(steps) +
                              " 2>/dev/null";
  std::unique_ptr<FILE, int (*)(FILE*)> const output(popen(command.c_str(), "r"), pclose);
  if (!output) return 0.0;
  double seconds = 0.0;
  double percent = 100.0;
  std::array<char, 512> line;
  while (std::fgets(line.data(), static_cast<int>(line.size()), output.get()) != nullptr) {
    std::sscanf(line.data(), "Loop time of %lf", &seconds);
    // On a busy machine the share of the core it had: "99.7% CPU use with 1 MPI tasks x 1 OpenMP threads".
    std::sscanf(line.data(), "%lf%% CPU use", &percent);
  }
  return seconds * percent / 100.0;
}

struct Least {
  double nanoseconds = 1e300;
  void consider(double other) { nanoseconds = other < nanoseconds ? other : nanoseconds; }
};

void print(char const* name, std::size_t n, Least const& least) {
  std::printf("lammps,%s,%zu,%.2g,%.2f,%.2f\n", name, n, packing_fraction, least.nanoseconds, 1e3 / least.nanoseconds);
  std::fflush(stdout);
}

bool race_at(std::size_t side, std::uint64_t steps, int rounds) {
  std::size_t const n = side * side;
  State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = n, .packing_fraction = packing_fraction}, 1);
  draw_velocities(state, {});
  auto const engine = make_engine({.kind = "tiled", .threads = 1}, state);
  Tally tally;
  engine->advance(state, tally, {.step = 200});
  double const items = static_cast<double>(n * steps);
  Least tiled;
  Least lammps;
  for (int round = 0; round < rounds; ++round) {
    double const begin = processor_seconds();
    engine->advance(state, tally, {.step = state.clock.step + steps});
    tiled.consider(1e9 * (processor_seconds() - begin) / items);
    // A wide skin makes lists that last long, a narrow one makes short lists: which is better depends on the caches.
    for (char const* const skin : {"0.2", "0.3"}) {
      double const seconds = lammps_seconds(side, steps, skin);
      if (seconds <= 0.0) return false;
      lammps.consider(1e9 * seconds / items);
    }
  }
  print("tiled 1 thread", n, tiled);
  print("LAMMPS gran/hooke 1 thread", n, lammps);
  return true;
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using gridlock::benchmark::race_at;
  std::printf("benchmark,name,n,packing_fraction,nanoseconds_min,million_disk_steps_a_second\n");
  bool is_there = true;
  if (argc > 1) {
    is_there = race_at(std::strtoull(argv[1], nullptr, 10), 200, 3);
  } else {
    is_there = race_at(100, 2000, 5) && race_at(316, 400, 3) && race_at(1000, 200, 2);
  }
  if (!is_there) std::printf("# LAMMPS is not installed: apt-get install lammps\n");
}
