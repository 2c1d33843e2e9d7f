#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {

/// Disks on a square lattice in a walled box, with velocities.
inline State gas(std::size_t n, double packing_fraction) {
  State state = make_start(Box(1.0, 1.0, Edge::wall), {.count = n, .packing_fraction = packing_fraction}, 1);
  draw_velocities(state, {});
  return state;
}

/// A system that has left its lattice; the largest ones are on their way, which makes no difference to the cost.
inline State mixed(std::size_t n, double packing_fraction) {
  State start = gas(n, packing_fraction);
  Counters counters;
  make_engine({.kind = "tiled"}, start)->advance(start, counters, {.step = n > 5'000'000 ? 40U : 200U});
  return start;
}

/// An engine that goes on from `start` by `steps` a round; the result is the hash of its state.
inline Contestant contestant(std::string name, State const& start, EngineSettings const& settings, std::uint64_t steps,
                             double (*clock)() = processor_seconds) {
  struct Run {
    State state;
    std::unique_ptr<Engine> engine;
    Counters counters;
  };
  auto const run = std::make_shared<Run>(Run{start, make_engine(settings, start), {}});
  return {.name = std::move(name),
          .items = static_cast<double>(start.agents.size() * steps),
          .run = [=] { run->engine->advance(run->state, run->counters, {.step = run->state.clock.step + steps}); },
          .result = [=] { return hash(run->state); },
          .clock = clock};
}

}  // namespace gridlock::benchmark
