// The paper's rule beside LAMMPS' granular disks, the same numbers of disks at the same packing fraction. Nanoseconds
// per disk and step, of processor time; `tiled` takes the paper's step once, and once one in which a disk goes as far
// as in a step of LAMMPS. The result is the hash of the state; LAMMPS' is not ours to hash. Without LAMMPS (Debian:
// apt-get install lammps) there is nothing to compare with. To be run from the root of the repository; lammps.py writes
// the results.
//
//     gridlock_bench_lammps [SIDE …]        SIDE × SIDE disks; default: 32 100 316 1000

#include <algorithm>
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

/// In a step of lammps_disks.in the root mean square of a disk's way is √2 thousandths of a diameter; ours is
/// time_step/√2 diameters, since the mean of v² is v_max²/2.
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

void race_at(std::size_t side) {
  std::size_t const n = side * side;
  std::uint64_t const steps = std::clamp<std::uint64_t>(40'000'000 / n, 200, 20'000);
  int const rounds = n > 20'000 ? 3 : 5;
  State const start = mixed(n, packing_fraction);
  std::vector<Contestant> contestants;
  // A wide skin makes lists that last long, a narrow one makes short lists: which is better depends on the caches.
  contestants.push_back(lammps(side, steps, "0.2"));
  contestants.push_back(lammps(side, steps, "0.3"));
  contestants.push_back(contestant("tiled the paper's step", start, {.kind = "tiled", .threads = 1}, steps));
  contestants.push_back(contestant("tiled LAMMPS' step", start,
                                   {.kind = "tiled", .time_step = time_step_as_in_lammps, .threads = 1}, steps));
  race("lammps", n, packing_fraction, rounds, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  using namespace gridlock::benchmark;
  std::vector<std::size_t> sides;
  for (int k = 1; k < argument_count; ++k) sides.push_back(std::strtoull(arguments[k], nullptr, 10));
  if (sides.empty()) sides = {32, 100, 316, 1000};
  print_header();
  if (lammps_seconds(10, 10, "0.3") <= 0.0) {
    std::printf("# LAMMPS is not installed: apt-get install lammps\n");
    return 0;
  }
  for (std::size_t const side : sides) race_at(side);
}
