#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace gridlock::benchmark {

/// The most memory this process has held so far, in bytes.
inline double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

/// Seconds of processor time of this process, all threads together.
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Seconds by the clock on the wall.
inline double wall_seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// One way of doing the same work: run() does one round of `items` pieces of it and leaves a number that shows what
/// came out.
struct Contestant {
  std::string name;
  double items = 1.0;  ///< pieces of work in one round
  std::function<void()> run;
  std::function<std::uint64_t()> result = [] { return std::uint64_t{0}; };
  double (*clock)() = processor_seconds;
  std::vector<double> nanoseconds = {};  ///< per piece, one entry a round
};

inline void print_header() {
  std::printf("benchmark,name,n,packing_fraction,nanoseconds_min,nanoseconds_median,speed_up,baseline,result\n");
}

/// Runs the contestants in turns, so that a busy machine is unfair to all alike, one round unmeasured to warm up, and
/// prints a row for each; speed_up is the least time of the first one over theirs.
inline void race(char const* benchmark, std::uint64_t n, double packing_fraction, int rounds,
                 std::vector<Contestant> contestants) {
  for (Contestant& c : contestants) c.run();
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& c : contestants) {
      double const start = c.clock();
      c.run();
      c.nanoseconds.push_back(1e9 * (c.clock() - start) / c.items);
    }
  }
  auto const least = [](Contestant const& c) { return *std::ranges::min_element(c.nanoseconds); };
  for (Contestant& c : contestants) {
    std::ranges::sort(c.nanoseconds);
    std::printf("%s,%s,%llu,%.4g,%.2f,%.2f,%.2f,%s,%016llx\n", benchmark, c.name.c_str(),
                static_cast<unsigned long long>(n), packing_fraction, least(c), c.nanoseconds[c.nanoseconds.size() / 2],
                least(contestants.front()) / least(c), contestants.front().name.c_str(),
                static_cast<unsigned long long>(c.result()));
    std::fflush(stdout);
  }
}

}  // namespace gridlock::benchmark
