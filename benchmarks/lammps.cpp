// The paper's rule beside LAMMPS' granular disks, the same numbers of disks at the same packing fraction. Nanoseconds per
// disk and step, of processor time; `tiled` takes the paper's step once, and once one in which a disk goes as far as in a
// step of LAMMPS. The result is the hash of the state; LAMMPS' is not ours to hash. Without LAMMPS (Debian: apt-get
// install lammps) there is nothing to compare with. To be run from the root of the repository. gridlock_bench_lammps SIDE
// runs SIDE × SIDE disks.

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "disks.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr double packing_fraction = 0.7;

/// In a step of lammps_disks.in the root mean square of a disk's way is √2 thousandths of a diameter; ours is time_step/√2
/// diameters, since the mean of v² is v_max²/2.
constexpr double time_step_as_in_lammps = 0.002;

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

/// All that LAMMPS has taken so far: the clock its rounds are measured by.
double all_lammps_seconds = 0.0;

Contestant lammps(std::size_t side, std::uint64_t steps, std::string const& skin) {
  return {.name = "LAMMPS gran/hooke skin " + skin,
          .items = static_cast<double>(side * side * steps),
          .run = [=] { all_lammps_seconds += lammps_seconds(side, steps, skin); },
          .clock = [] { return all_lammps_seconds; }};
}

void race_at(std::size_t side, std::uint64_t steps, int rounds) {
  State const start = mixed(side * side, packing_fraction);
  std::vector<Contestant> contestants;
  contestants.push_back(contestant("tiled the paper's step", start, {.kind = "tiled", .threads = 1}, steps));
  contestants.push_back(contestant("tiled LAMMPS' step", start,
                                   {.kind = "tiled", .time_step = time_step_as_in_lammps, .threads = 1}, steps));
  // A wide skin makes lists that last long, a narrow one makes short lists: which is better depends on the caches.
  contestants.push_back(lammps(side, steps, "0.2"));
  contestants.push_back(lammps(side, steps, "0.3"));
  race("lammps", side * side, packing_fraction, rounds, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  if (lammps_seconds(10, 10, "0.3") <= 0.0) {
    std::printf("# LAMMPS is not installed: apt-get install lammps\n");
  } else if (argc > 1) {
    race_at(std::strtoull(argv[1], nullptr, 10), 200, 3);
  } else {
    race_at(100, 2000, 5);
    race_at(316, 400, 3);
    race_at(1000, 200, 3);
  }
}
