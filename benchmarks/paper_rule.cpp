// The paper's rule on every grid and engine. Nanoseconds per disk and step; the result is the hash of the state, the
// same for `stepped` on every grid.

#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

State gas(std::size_t n, double packing_fraction) {
  State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = n, .packing_fraction = packing_fraction}, 1);
  draw_velocities(state, {});
  return state;
}

Contestant contestant(std::string name, State const& start, EngineSettings const& settings, std::uint64_t steps,
                      double (*clock)() = processor_seconds) {
  struct Run {
    State state;
    std::unique_ptr<Engine> engine;
    Tally tally;
  };
  auto const run = std::make_shared<Run>(Run{start, make_engine(settings, start), {}});
  return {.name = std::move(name),
          .items = static_cast<double>(start.disks.size() * steps),
          .run = [=] { run->engine->advance(run->state, run->tally, {.step = run->state.clock.step + steps}); },
          .result = [=] { return hash(run->state); },
          .clock = clock};
}

void race_at(std::size_t n, double packing_fraction) {
  // A system that has left its lattice.
  State start = gas(n, packing_fraction);
  Tally tally;
  EngineSettings const packed{.kind = "stepped", .grid = GridKind::packed};
  make_engine(packed, start)->advance(start, tally, {.step = n > 500'000 ? 40U : 200U});
  std::uint64_t const steps = std::max<std::uint64_t>(4, 400'000 / n);
  std::vector<Contestant> contestants;
  if (n < 2000) {
    contestants.push_back(
        contestant("linked k=10", start, {.kind = "stepped", .cells = 10, .grid = GridKind::linked}, steps));
  }
  contestants.push_back(contestant("linked", start, {.kind = "stepped", .grid = GridKind::linked}, steps));
  contestants.push_back(contestant("packed", start, packed, steps));
  race("paper_rule", n, packing_fraction, n > 500'000 ? 3 : 9, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  if (argc > 2) {
    race_at(std::strtoull(argv[1], nullptr, 10), std::strtod(argv[2], nullptr));
    return 0;
  }
  for (double const packing_fraction : {0.3, 0.5, 0.7}) {
    for (std::size_t const n : {841U, 10'000U, 1'000'000U}) race_at(n, packing_fraction);
  }
}
