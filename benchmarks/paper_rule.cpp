// The paper's rule on every grid and engine. Nanoseconds per disk and step, of processor time unless it says wall time;
// the result is the hash of the state, the same for `stepped` on every grid after the same number of steps, and for
// `tiled` on any number of threads. gridlock_bench_paper_rule N PHI runs one size, 10000000 0.5 for example, and
// gridlock_bench_paper_rule N PHI k the lists of that size over the number of cells, N PHI threads one thread beside
// two, N PHI engines `stepped` beside `tiled` on one thread.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "disks.hpp"
#include "engine/stepped.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

EngineSettings linked(std::optional<std::uint64_t> cells) {
  return {.kind = "stepped", .cells = cells, .grid = GridKind::linked};
}

EngineSettings tiled(std::uint64_t threads) { return {.kind = "tiled", .threads = threads}; }

void race_at(std::size_t n, double packing_fraction) {
  State const start = mixed(n, packing_fraction);
  bool const is_large = n > 500'000;
  bool const is_huge = n > 5'000'000;
  // Enough steps for `tiled` to pay for its sort of the disks as often as in a long run.
  std::uint64_t const steps = std::max<std::uint64_t>(100, 400'000 / n);
  std::uint64_t const few = is_huge ? 1 : is_large ? 4 : steps;
  std::vector<Contestant> contestants;
  if (n < 2000) contestants.push_back(contestant("lists k=10", start, linked(10), steps));
  contestants.push_back(contestant("lists finest k", start, linked({}), few));
  if (!is_huge) contestants.push_back(contestant("stepped", start, {.kind = "stepped"}, few));
  contestants.push_back(contestant("tiled 1 thread", start, tiled(1), steps));
  if (!is_huge) {
    contestants.push_back(contestant("tiled 1 thread (wall)", start, tiled(1), steps, wall_seconds));
    contestants.push_back(contestant("tiled 2 threads (wall)", start, tiled(2), steps, wall_seconds));
  }
  race("paper_rule", n, packing_fraction, is_huge ? 1 : is_large ? 3 : 9, std::move(contestants));
}

/// `tiled` on one thread and on two, by the clock on the wall.
void race_threads(std::size_t n, double packing_fraction) {
  State const start = mixed(n, packing_fraction);
  // The disks are sorted, on one thread, as often as in a long run.
  std::uint64_t const steps = std::max<std::uint64_t>(100, 4'000'000 / n);
  std::vector<Contestant> contestants;
  contestants.push_back(contestant("tiled 1 thread (wall)", start, tiled(1), steps, wall_seconds));
  contestants.push_back(contestant("tiled 2 threads (wall)", start, tiled(2), steps, wall_seconds));
  race("paper_rule", n, packing_fraction, 5, std::move(contestants));
}

/// `stepped` beside `tiled` on one thread.
void race_engines(std::size_t n, double packing_fraction) {
  State const start = mixed(n, packing_fraction);
  std::uint64_t const steps = std::max<std::uint64_t>(100, 400'000 / n);
  std::vector<Contestant> contestants;
  contestants.push_back(contestant("stepped", start, {.kind = "stepped"}, n > 500'000 ? 4 : steps));
  contestants.push_back(contestant("tiled 1 thread", start, tiled(1), steps));
  race("paper_rule", n, packing_fraction, n > 500'000 ? 3 : 9, std::move(contestants));
}

/// The paper's Figure 5 over more decades: lists of k × k cells from one far too coarse to the finest.
void race_over_k(std::size_t n, double packing_fraction) {
  State const start = mixed(n, packing_fraction);
  double const finest = stepped_layout({.grid = GridKind::linked}, start).columns();
  std::vector<Contestant> contestants;
  for (int halvings = 0; halvings < 6; ++halvings) {
    auto const k = static_cast<std::uint64_t>(finest / std::pow(2.0, halvings));
    // Some 4^halvings disks a cell: a step must not take minutes.
    if (k < 3 || std::pow(4.0, halvings) * static_cast<double>(n) > 3e8) break;
    double const budget = 4e6 / static_cast<double>(n) / std::pow(4.0, halvings);
    auto const steps = static_cast<std::uint64_t>(std::max(1.0, budget));
    contestants.push_back(contestant("lists k=" + std::to_string(k), start, linked(k), steps));
  }
  race("paper_rule_over_k", n, packing_fraction, n > 500'000 ? 1 : 3, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  if (argc > 3) {
    std::string const asked_for = argv[3];
    auto const race_asked_for = asked_for == "threads"   ? race_threads
                                : asked_for == "engines" ? race_engines
                                                         : race_over_k;
    race_asked_for(std::strtoull(argv[1], nullptr, 10), std::strtod(argv[2], nullptr));
    return 0;
  }
  if (argc > 2) {
    race_at(std::strtoull(argv[1], nullptr, 10), std::strtod(argv[2], nullptr));
    return 0;
  }
  for (double const packing_fraction : {0.3, 0.5, 0.7}) {
    for (std::size_t const n : {841U, 10'000U, 100'000U, 1'000'000U, 10'000'000U}) race_at(n, packing_fraction);
  }
  for (std::size_t const n : {100U, 841U, 10'000U, 100'000U, 1'000'000U, 10'000'000U}) race_over_k(n, 0.7);
}
