#pragma once

#include "engine/hot_disks.hpp"
#include "engine/turn.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::reference {

/// The engine `stepped` without a grid: the same turns, each looking at every other disk.
inline void advance_all_pairs(State& state, EngineSettings const& settings, Counters& counters, std::uint64_t steps) {
  double const duration = step_duration(settings, state);
  HotDisks disks(state, rows_in_order(state.agents.ids()));
  TurnView const view = disks.view(state.box, settings, duration);
  for (std::uint64_t n = 0; n < steps; ++n) {
    for (std::size_t i = 0; i < disks.size(); ++i) {
      take_turn(view, i, counters, [&](Partner& partner) {
        for (std::size_t j = 0; j < disks.size(); ++j) partner.consider(j);
      });
    }
    ++state.clock.step;
    state.clock.time += duration;
  }
  disks.write_back(state);
}

}  // namespace gridlock::reference
