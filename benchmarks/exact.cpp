// The engine `exact` in the fluid at φ = 0.70, periodic, equal disks, one core: nanoseconds of processor time per
// collision after equilibration, the state's hash at the end, and the memory of state and engine per disk.
//
//     gridlock_bench_exact [N …]        default: 1024 10000 100000 1000000
//     gridlock_bench_exact --start FILE COLLISIONS BLOCK REPEATS [RESTITUTION]
//
// The second form goes on from a file of extended XYZ, for COLLISIONS that do not count and then for REPEATS blocks of
// BLOCK collisions, and prints the time of each, the compressibility factor βP/ρ, the mean kinetic energy of a disk and
// the state's hash: edmd.py and dynamo.py read them.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string_view>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/io/xyz.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr double packing_fraction = 0.70;
/// Disks of diameter 1 on a square lattice with Maxwell velocities: it melts within a few collisions a disk.
State lattice(std::uint64_t n) {
  auto const columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(n))));
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi / 4.0 / packing_fraction);
  double const step = side / static_cast<double>(columns);
  State state{.box = Box(side, side, Edge::periodic), .seed = 1};
  state.agents.reserve(n);
  for (std::uint64_t i = 0; i < n; ++i) {
    RandomStream random(1, 0, i, Purpose::start_velocity);
    double const velocity_x = random.normal();
    double const velocity_y = random.normal();
    state.agents.add((static_cast<double>(i % columns) + 0.5) * step, (static_cast<double>(i / columns) + 0.5) * step,
                     velocity_x, velocity_y, 0.5, 1.0, 0, 0);
  }
  return state;
}

/// The nanoseconds of a collision in each block, by one clock.
using Nanoseconds = std::vector<double>;

struct Blocks {
  Nanoseconds processor;
  Nanoseconds wall;
};

/// Measures `repeats` blocks of so many collisions, after those counted so far.
Blocks measure_blocks(Engine& engine, State& state, Counters& counters, std::uint64_t block, int repeats) {
  Blocks blocks;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    double const processor_start = processor_seconds();
    double const wall_start = wall_seconds();
    std::uint64_t const before = counters.pair_collisions;
    engine.advance(state, counters, {.pair_collisions = before + block});
    blocks.processor.push_back(1e9 * (processor_seconds() - processor_start) / static_cast<double>(block));
    blocks.wall.push_back(1e9 * (wall_seconds() - wall_start) / static_cast<double>(block));
  }
  return blocks;
}

void measure(std::uint64_t n) {
  constexpr int repeats = 7;
  double const memory_before = peak_bytes();
  State state = lattice(n);
  double const memory_of_state = peak_bytes();
  auto const engine = make_engine({.kind = "exact"}, state);
  Counters counters;
  // Ten collisions a disk melt the lattice; a hundred bring small systems, which cost nothing, to equilibrium.
  std::uint64_t const equilibration = n * (n < 50'000 ? 100 : 10);
  engine->advance(state, counters, {.pair_collisions = equilibration});
  std::uint64_t const block = std::clamp<std::uint64_t>(2 * n, 200'000, 2'000'000);
  Nanoseconds nanoseconds = measure_blocks(*engine, state, counters, block, repeats).processor;
  std::ranges::sort(nanoseconds);
  double const memory = peak_bytes();
  double const disks = static_cast<double>(n);
  std::printf("exact,%llu,%.2f,%.1f,%.1f,%.3f,%.3f,%.0f,%.0f,%016llx\n", static_cast<unsigned long long>(n),
              packing_fraction, nanoseconds.front(), nanoseconds[repeats / 2], 1e3 / nanoseconds.front(),
              1e3 / nanoseconds[repeats / 2], (memory - memory_of_state) / disks, (memory - memory_before) / disks,
              static_cast<unsigned long long>(hash(state)));
  std::fflush(stdout);
}

void measure_from(char const* start, std::uint64_t collisions, std::uint64_t block, int repeats, double restitution) {
  State state = read_xyz(start).state;
  EngineSettings const settings{.kind = "exact", .threads = 1, .collisions = {.restitution = restitution}};
  auto const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.pair_collisions = collisions});
  double const time_before = state.clock.time;
  double const virial_before = counters.pair_virial;
  Blocks const blocks = measure_blocks(*engine, state, counters, block, repeats);
  for (double const nanoseconds : blocks.processor) std::printf("nanoseconds %.17g\n", nanoseconds);
  for (double const nanoseconds : blocks.wall) std::printf("nanoseconds_by_the_clock %.17g\n", nanoseconds);
  // βP/ρ = 1 + Σ σ |Δp| / (2 N kT t), and 2 N kT = Σ m v², for elastic disks.
  double const virial = counters.pair_virial - virial_before;
  double const duration = state.clock.time - time_before;
  std::printf("compressibility_factor %.17g\n", 1.0 + virial / (2.0 * kinetic_energy(state.agents) * duration));
  std::printf("kinetic_energy %.17g\n", kinetic_energy(state.agents) / static_cast<double>(state.agents.size()));
  std::printf("state_hash %016llx\n", static_cast<unsigned long long>(hash(state)));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  if ((argument_count == 6 || argument_count == 7) && std::string_view(arguments[1]) == "--start") {
    gridlock::benchmark::measure_from(arguments[2], std::strtoull(arguments[3], nullptr, 10),
                                      std::strtoull(arguments[4], nullptr, 10), std::atoi(arguments[5]),
                                      argument_count == 7 ? std::strtod(arguments[6], nullptr) : 1.0);
    return 0;
  }
  std::vector<std::uint64_t> sizes;
  for (int k = 1; k < argument_count; ++k) sizes.push_back(std::strtoull(arguments[k], nullptr, 10));
  if (sizes.empty()) sizes = {1024, 10'000, 100'000, 1'000'000};
  std::printf(
      "benchmark,n,packing_fraction,nanoseconds_min,nanoseconds_median,million_collisions_per_second_max,"
      "million_collisions_per_second_median,engine_bytes_per_disk,bytes_per_disk,state_hash\n");
  for (std::uint64_t const n : sizes) gridlock::benchmark::measure(n);
}
