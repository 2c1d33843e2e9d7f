// Soft disks, half of diameter D and half of 1.4 D, from random points of a periodic square: a quench at a packing
// fraction, and where a pressure is given the decompression to it. Wall time, iterations and what came out, a row for
// each start.
//
//     gridlock_bench_soft_disks [N [PACKING_FRACTION [STARTS [PRESSURE [THREADS]]]]]      default: 1024 0.86 3, no decompression, 1

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "gridlock/packing/pressure_ramp.hpp"
#include "tests/reference/random_packing.hpp"

namespace gridlock::benchmark {
namespace {

using Time = std::chrono::steady_clock;

double seconds_since(Time::time_point start) { return std::chrono::duration<double>(Time::now() - start).count(); }

/// The same for the same bits of all positions and radii.
std::uint64_t hash_of(Packing const& packing) {
  State state{.box = packing.box};
  for (std::size_t i = 0; i < packing.size(); ++i) {
    state.agents.add(packing.x[i], packing.y[i], 0.0, 0.0, packing.radius[i], 1.0, 0, 0);
  }
  return hash(state);
}

void row(char const* what, std::size_t disks, std::uint64_t seed, std::uint64_t threads, double seconds,
         Minimizer const& minimizer, double packing_fraction, Packing const& packing) {
  std::printf("%s,%zu,%llu,%llu,%.4f,%llu,%llu,%llu,%.10g,%.12f,%016llx\n", what, disks,
              static_cast<unsigned long long>(seed), static_cast<unsigned long long>(threads), seconds,
              static_cast<unsigned long long>(minimizer.fire_iterations()),
              static_cast<unsigned long long>(minimizer.quasi_newton_iterations()),
              static_cast<unsigned long long>(minimizer.newton_iterations()), minimizer.pressure(), packing_fraction,
              static_cast<unsigned long long>(hash_of(packing)));
  std::fflush(stdout);
}

void measure(std::size_t disks, double packing_fraction, std::uint64_t seed, double pressure, std::uint64_t threads) {
  MinimizerSettings const settings{.threads = threads};
  Packing const start_packing = reference::random_packing(disks, packing_fraction, seed, Edge::periodic, 1.0);
  Time::time_point const start = Time::now();
  Minimizer quench(settings, start_packing);
  quench.advance();
  row("quench", disks, seed, threads, seconds_since(start), quench, packing_fraction, quench.packing());
  if (!(pressure > 0.0)) return;
  PressureRamp ramp({.minimizer = settings, .pressure = pressure}, quench.packing());
  ramp.advance();
  row("quench and decompress", disks, seed, threads, seconds_since(start), ramp.minimizer(),
      ramp.levels().back().jamming_packing_fraction, ramp.packing());
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  auto const number = [&](int k, double otherwise) {
    return argument_count > k ? std::strtod(arguments[k], nullptr) : otherwise;
  };
  auto const disks = static_cast<std::size_t>(number(1, 1024));
  auto const starts = static_cast<std::uint64_t>(number(3, 3));
  std::printf(
      "benchmark,n,seed,threads,seconds,fire_iterations,quasi_newton_iterations,newton_iterations,pressure,"
      "packing_fraction,state_hash\n");
  for (std::uint64_t seed = 1; seed <= starts; ++seed) {
    gridlock::benchmark::measure(disks, number(2, 0.86), seed, number(4, 0.0),
                                 static_cast<std::uint64_t>(number(5, 1)));
  }
}
