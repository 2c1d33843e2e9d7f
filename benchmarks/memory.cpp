// How many bytes a disk takes: the state alone, and the most that was in use while `tiled` took steps. The result is
// the hash of the state. gridlock_bench_memory N PHI STEPS runs one size.

#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

void weigh(std::size_t n, double packing_fraction, std::uint64_t steps) {
  auto const per_disk = [&](double bytes) { return bytes / static_cast<double>(n); };
  State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = n, .packing_fraction = packing_fraction}, 1);
  draw_velocities(state, {});
  double const at_start = peak_bytes();
  Counters counters;
  make_engine({.kind = "tiled", .threads = 1}, state)->advance(state, counters, {.step = steps});
  double const at_most = peak_bytes();
  std::printf("memory,%zu,%.2g,%.1f,%.1f,%016llx\n", n, packing_fraction, per_disk(at_start), per_disk(at_most),
              static_cast<unsigned long long>(hash(state)));
  std::fflush(stdout);
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  std::printf("benchmark,n,packing_fraction,bytes_per_disk_after_start,bytes_per_disk_at_most,result\n");
  if (argc > 3) {
    gridlock::benchmark::weigh(std::strtoull(argv[1], nullptr, 10), std::strtod(argv[2], nullptr),
                               std::strtoull(argv[3], nullptr, 10));
    return 0;
  }
  // The most ever held can only grow: the emptiest system, which has the most cells for each disk, comes last.
  for (double const packing_fraction : {0.7, 0.5, 0.3}) gridlock::benchmark::weigh(1'000'000, packing_fraction, 2);
}
