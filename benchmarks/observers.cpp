// What it costs to watch: a million disks by the engine alone, and in a run that reports progress after every chunk of
// work and samples every observable of the series every 100 steps. Nanoseconds per disk and step, of processor time;
// the result is the hash of the state, the same for both. gridlock_bench_observers N runs one size.

#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

constexpr std::uint64_t steps = 100;

struct Alone {
  State state;
  std::unique_ptr<Engine> engine;
  Counters counters;
};

void race_at(std::size_t n) {
  Configuration configuration;
  configuration.disks = {.count = n, .packing_fraction = 0.7};
  configuration.engine = {.kind = "tiled", .threads = 1};
  configuration.run.steps = 1'000'000;
  configuration.observe.every = steps;
  configuration.observe.structure_every = 0;
  Setup setup = set_up(configuration);
  auto const alone =
      std::make_shared<Alone>(Alone{disks_of(setup), make_engine(configuration.engine, disks_of(setup)), {}});
  RunPlan const plan = plan_of(setup);
  std::shared_ptr<Simulation> const simulation = std::move(setup.simulation);
  auto const run = std::make_shared<Run>(*simulation, plan);
  auto const target = std::make_shared<std::uint64_t>(0);
  auto const items = static_cast<double>(n * steps);
  std::vector<Contestant> contestants;
  contestants.push_back(
      {.name = "engine alone",
       .items = items,
       .run = [=] { alone->engine->advance(alone->state, alone->counters, {.step = alone->state.clock.step + steps}); },
       .result = [=] { return hash(alone->state); }});
  contestants.push_back({.name = "run with progress and observables",
                         .items = items,
                         .run =
                             [=] {
                               *target += steps;
                               run->advance([&](Progress const& progress) { return progress.steps < *target; });
                             },
                         .result = [=] { return simulation->state_hash(); }});
  race("observers", n, 0.7, 5, std::move(contestants));
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int argc, char** argv) {
  using namespace gridlock::benchmark;
  print_header();
  race_at(argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000);
}
