// Self-propelled disks of the engine `tiled` on one thread, from a file of extended XYZ, whose velocities are their
// headings: swimmers.py runs it beside LAMMPS.
//
//     gridlock_bench_swimmers START ROTATIONAL_DIFFUSION TIME_STEP STEPS REPEATS
//
// Prints the nanoseconds of a disk and step in each of REPEATS blocks of so many steps, of processor time and by the
// clock, the share of turns that end halted, and the hash of the state. The first block is there to warm up: it is not
// printed. A disk of diameter 1 swims at the speed 1, so that TIME_STEP is the length of a step in diameters.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "gridlock/engine/engine.hpp"
#include "gridlock/io/xyz.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

void measure(char const* start, double rotational_diffusion, double time_step, std::uint64_t steps, int repeats) {
  State state = read_xyz(start).state;
  EngineSettings settings;
  settings.kind = "tiled";
  settings.time_step = time_step;
  settings.speed = 1.0;
  settings.threads = 1;
  settings.propulsion = {.speed = 1.0, .rotational_diffusion = rotational_diffusion};
  std::unique_ptr<Engine> const engine = make_engine(settings, state);
  Counters counters;
  engine->advance(state, counters, {.step = state.clock.step + steps});
  std::uint64_t const halts_before = counters.pair_collisions;
  double const disk_steps = static_cast<double>(state.agents.size()) * static_cast<double>(steps);
  for (int repeat = 0; repeat < repeats; ++repeat) {
    double const processor_begin = processor_seconds();
    double const wall_begin = wall_seconds();
    engine->advance(state, counters, {.step = state.clock.step + steps});
    std::printf("nanoseconds %.17g %.17g\n", 1e9 * (processor_seconds() - processor_begin) / disk_steps,
                1e9 * (wall_seconds() - wall_begin) / disk_steps);
  }
  std::printf("halted %.4f\n", static_cast<double>(counters.pair_collisions - halts_before) / (disk_steps * repeats));
  std::printf("state_hash %016llx\n", static_cast<unsigned long long>(hash(state)));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  if (argument_count != 6) {
    std::fprintf(stderr, "usage: %s START ROTATIONAL_DIFFUSION TIME_STEP STEPS REPEATS\n", arguments[0]);
    // `./dev bench` runs every benchmark without arguments.
    return argument_count == 1 ? 0 : 2;
  }
  gridlock::benchmark::measure(arguments[1], std::strtod(arguments[2], nullptr), std::strtod(arguments[3], nullptr),
                               std::strtoull(arguments[4], nullptr, 10), std::atoi(arguments[5]));
  return 0;
}
