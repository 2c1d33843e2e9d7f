// Growth of a mixture of disks, half of diameter D, half of 1.4 D, from packing fraction 0.40 in a periodic square, on
// one core: processor time and what came out at each decade of the reduced pressure.
//
//     gridlock_bench_growth [RATE [N [PRESSURE [SEED]]]]      default: 0.002236 1000 1e12 1
//
// The default rate is dD/dt = 1e-3 at kT = 0.2.

#include "gridlock/engine/growth.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "gridlock/engine/engine.hpp"
#include "measure.hpp"
#include "tests/reference/fluid_of_two_sizes.hpp"

namespace gridlock::benchmark {
namespace {

void measure(double rate, std::uint64_t n, double last_pressure, std::uint64_t seed) {
  State state = reference::fluid_of_two_sizes(n, 1.4, seed);
  Counters counters;
  double seconds = 0.0;
  for (double pressure = 10.0; pressure < 1.5 * last_pressure; pressure *= 10.0) {
    double const start = processor_seconds();
    std::uint64_t const collisions = counters.pair_collisions;
    Growth growth({.rate = rate, .pressure = pressure}, state);
    growth.advance(state, counters);
    double const passed = processor_seconds() - start;
    seconds += passed;
    std::printf("growth,%g,%llu,%llu,%.0e,%.4g,%.12f,%.3f,%.3f,%.1f,%.3f,%016llx\n", rate,
                static_cast<unsigned long long>(n), static_cast<unsigned long long>(seed), pressure,
                growth.reduced_pressure().value_or(0.0), covered_area(state.agents) / state.box.area(),
                static_cast<double>(counters.pair_collisions) / static_cast<double>(n), seconds,
                1e9 * passed / static_cast<double>(counters.pair_collisions - collisions),
                static_cast<double>(counters.moves) / static_cast<double>(counters.pair_collisions),
                static_cast<unsigned long long>(hash(state)));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  double const rate = argument_count > 1 ? std::strtod(arguments[1], nullptr) : 1e-3 / std::sqrt(0.2);
  std::uint64_t const n = argument_count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1000;
  double const pressure = argument_count > 3 ? std::strtod(arguments[3], nullptr) : 1e12;
  std::uint64_t const seed = argument_count > 4 ? std::strtoull(arguments[4], nullptr, 10) : 1;
  std::printf(
      "benchmark,rate,n,seed,pressure,pressure_reached,packing_fraction,collisions_a_disk,seconds,nanoseconds_a_"
      "collision,"
      "events_a_collision,state_hash\n");
  gridlock::benchmark::measure(rate, n, pressure, seed);
}
