// The engine `exact` on one thread and on several, in turns: nanoseconds of a collision by the clock, how many times as
// fast several threads are, and whether both end in the same state.
//
//     gridlock_bench_exact_threads [THREADS [N …]]        default: 2 100000 1000000

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::benchmark {
namespace {

/// About n disks of diameter 1 with Maxwell velocities in a periodic box: on a square lattice, which melts, or a
/// crystal.
State start(double packing_fraction, std::uint64_t n, bool is_crystal) {
  auto const columns = static_cast<std::uint64_t>(std::lround(std::sqrt(static_cast<double>(n))));
  std::uint64_t const rows = columns / 2 * 2;
  double const squeeze = is_crystal ? std::sqrt(3.0) / 2.0 : 1.0;
  double const step = std::sqrt(std::numbers::pi / 4.0 / packing_fraction / squeeze);
  State state{
      .box = Box(step * static_cast<double>(columns), step * squeeze * static_cast<double>(rows), Edge::periodic),
      .seed = 1};
  state.agents.reserve(columns * rows);
  for (std::uint64_t row = 0; row < rows; ++row) {
    for (std::uint64_t column = 0; column < columns; ++column) {
      RandomStream random(1, 0, row * columns + column, Purpose::start_velocity);
      double const velocity_x = random.normal();
      double const velocity_y = random.normal();
      double const x = static_cast<double>(column) + (is_crystal && row % 2 == 1 ? 0.75 : 0.25);
      state.agents.add(x * step, (static_cast<double>(row) + 0.5) * step * squeeze, velocity_x, velocity_y, 0.5, 1.0, 0,
                       0);
    }
  }
  return state;
}

struct Run {
  State state;
  std::unique_ptr<Engine> engine;
  Counters counters;
  std::vector<double> seconds;

  Run(State const& start, std::uint64_t threads)
      : state(start), engine(make_engine({.kind = "exact", .threads = threads}, state)) {}

  void advance(double time) {
    auto const begin = std::chrono::steady_clock::now();
    engine->advance(state, counters, {.time = time});
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
};

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void measure(double packing_fraction, std::uint64_t n, bool is_crystal, std::uint64_t threads) {
  bool const are_many = n > 500'000;
  int const rounds = are_many ? 11 : 41;
  double const melting = are_many ? 12.0 : 30.0;    // collisions a disk
  double const collisions = are_many ? 8.0 : 20.0;  // of a disk in a round
  State const begin = start(packing_fraction, n, is_crystal);
  double const disks = static_cast<double>(begin.agents.size());
  Run one(begin, 1);
  Run many(begin, threads);
  one.engine->advance(one.state, one.counters, {.pair_collisions = static_cast<std::uint64_t>(melting * disks)});
  double const melted = one.state.clock.time;
  many.advance(melted);
  one.advance(melted);
  one.seconds.clear();
  many.seconds.clear();
  std::uint64_t const before = one.counters.pair_collisions;
  std::vector<double> gains;
  for (int round = 1; round <= rounds; ++round) {
    double const time = melted * (1.0 + round * collisions / melting);
    one.advance(time);
    many.advance(time);
    gains.push_back(one.seconds.back() / many.seconds.back());
  }
  double const per_round = static_cast<double>(one.counters.pair_collisions - before) / rounds;
  double const min_of_one = std::ranges::min(one.seconds);
  double const min_of_many = std::ranges::min(many.seconds);
  bool const is_same = hash(one.state) == hash(many.state) && one.counters.pair_virial == many.counters.pair_virial;
  std::printf("%.2f,%.0f,%llu,%.1f,%.1f,%.2f,%.2f,%016llx,%s\n", packing_fraction, disks,
              static_cast<unsigned long long>(threads), 1e9 * min_of_one / per_round, 1e9 * min_of_many / per_round,
              min_of_one / min_of_many, median(gains), static_cast<unsigned long long>(hash(many.state)),
              is_same ? "same" : "DIFFERENT");
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argument_count, char** arguments) {
  std::uint64_t const threads = argument_count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 2;
  std::vector<std::uint64_t> sizes;
  for (int k = 2; k < argument_count; ++k) sizes.push_back(std::strtoull(arguments[k], nullptr, 10));
  if (sizes.empty()) sizes = {100'000, 1'000'000};
  std::printf(
      "packing_fraction,n,threads,nanoseconds_one_thread_min,nanoseconds_min,gain_of_min,gain_median,state_hash,"
      "bits\n");
  for (std::uint64_t const n : sizes) {
    gridlock::benchmark::measure(0.30, n, false, threads);
    gridlock::benchmark::measure(0.70, n, false, threads);
    gridlock::benchmark::measure(0.85, n, true, threads);
  }
}
