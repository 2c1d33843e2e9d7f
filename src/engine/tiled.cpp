#include "tiled.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <string_view>
#include <utility>

#include "engine/hot_disks.hpp"
#include "engine/tiled/shared_engine.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "packed_turns.hpp"
#include "stepped.hpp"

namespace gridlock {

namespace {

std::vector<std::uint32_t> all_tiles(Tiling const& tiling) {
  std::vector<std::uint32_t> tiles(tiling.tiles().size());
  std::iota(tiles.begin(), tiles.end(), 0U);
  return tiles;
}

/// Returns the object that takes the turns of all disks of a state.
tiled::Steps steps_of(State const& state, tiled::TurnRule const& rule, CellLayout const& layout, Tiling const& tiling) {
  std::vector<std::uint32_t> const tiles = all_tiles(tiling);
  std::vector<std::uint32_t> const order =
      tiled::CellOfTurn(layout, tiling, tiles).order(state.agents.size(), [&](std::size_t i) {
        return position(state.agents, i);
      });
  return {
      HotDisks(state, order), rule, layout, tiling, {.end_column = layout.columns(), .end_row = layout.rows()}, tiles};
}

/// Lets all disks take their turns. `for_each(parts, take)` calls take(part) for each part, in any order or at once.
template <class ForEach>
void take_step(tiled::Steps& steps, std::uint64_t step, std::vector<Tiling::Round> const& rounds, Counters& counters,
               ForEach for_each) {
  steps.begin_step(step);
  for (Tiling::Round const& round : rounds) {
    for_each(round.size(), [&](std::size_t part) { steps.take_part(round[part]); });
  }
  CountersOfStep of_step;
  for (tiled::TileResult& result : steps.results()) {
    // Disks too fast for their tile go in the order of tiles, because one may change the turn of the next.
    for (std::uint32_t const i : result.not_local) steps.take_late(i, result);
    result.not_local.clear();
    of_step.add(result.counters);
    result.counters = {};
  }
  of_step.add_to(counters);
}

/// Throws RunFailure where a disk has become so fast that it could jump over another in a sub-step.
void require_no_jumps(tiled::Steps const& steps, State const& state) {
  for (tiled::TileResult const& result : steps.results()) {
    if (result.too_fast) throw_long_substep(state, result.too_fast->row_in_state, result.too_fast->displacement);
  }
}

}  // namespace

EngineRecord tiled_record() {
  return {.name = "tiled",
          .documentation = "the same moves in an order that all cores can share",
          .uses_threads = true,
          .uses_processes = true,
          .bytes_per_disk = 232.0,
          .bytes_per_disk_of_checkpoint = 19.0,
          .unused_because_of =
              [](EngineSettings const& /*settings*/, std::string_view setting) {
                bool const is_unused = setting == "audit_every" || setting == "grid" || setting == "cells";
                return std::string_view(is_unused ? "kind" : "");
              },
          .cost_of_move = [](EngineSettings const& /*settings*/, State const& /*state*/) { return 1.0; },
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            if (settings.processes.count() > 1) return std::make_unique<SharedTiledEngine>(settings, state);
            return std::make_unique<TiledEngine>(settings, state);
          }};
}

TiledEngine::TiledEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), box_(state.box), thread_pool_(settings.threads) {
  require_room_for_turns(settings, state);
  lay_out(state);
}

void TiledEngine::require_valid(State const& state) const { require_room_for_turns(settings_, state); }

void TiledEngine::lay_out(State const& state) {
  layout_ = tiled_layout(settings_, state.box, overview_of(state.agents));
  tiling_ = Tiling(layout_);
  rounds_ = tiling_.rounds(thread_pool_.size());
}

tiled::TurnRule TiledEngine::rule_of(State const& state) const {
  RadiusRange const radii = radius_range(state.agents);
  return {.box = state.box,
          .duration = duration_,
          .substeps = settings_.substeps,
          .contact = settings_.contact,
          .radii = radii,
          .heading = heading_rule(settings_.propulsion, duration_, state.seed),
          .walls = walls_of(settings_.walls, state.box, radii.largest)};
}

void TiledEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (state.box != box_) {
    box_ = state.box;
    lay_out(state);
  }
  auto const is_before_stop = [&] { return !stop_condition.is_reached(state.clock, counters.pair_collisions); };
  bool is_stopped = false;
  while (is_before_stop() && !is_stopped) {
    tiled::Steps steps = steps_of(state, rule_of(state), layout_, tiling_);
    for (std::uint64_t n = 0; n < tiled::steps_between_sorts && is_before_stop() && !is_stopped; ++n) {
      take_step(steps, state.clock.step, rounds_, counters,
                [&](std::size_t parts, auto take) { thread_pool_.for_each(parts, take); });
      try {
        require_no_jumps(steps, state);
      } catch (RunFailure const&) {
        steps.disks().write_back(state);
        throw;
      }
      ++state.clock.step;
      state.clock.time += duration_;
      is_stopped = stop_condition.stops_here();
    }
    steps.disks().write_back(state);
  }
}

}  // namespace gridlock
