#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "engine/turn.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::reference {

/// The engine `stepped` without a grid: the same turns, each looking at every other disk.
inline void advance_all_pairs(State& state, EngineSettings const& settings, Tally& tally, std::uint64_t steps) {
  double const duration = step_duration(settings, state);
  TurnView const view = view_for_turns(state, settings, duration);
  std::vector<std::size_t> order(state.disks.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t row) { return state.disks.ids()[row]; });
  for (std::uint64_t n = 0; n < steps; ++n) {
    for (std::size_t const i : order) {
      take_turn(view, i, tally, [&](Partner& partner) {
        for (std::size_t j = 0; j < view.x.size(); ++j) partner.consider(j);
      });
    }
    ++state.clock.step;
    state.clock.time += duration;
  }
}

}  // namespace gridlock::reference
