#include "tiled.hpp"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "engine/hot_disks.hpp"
#include "engine/tiled/shared_engine.hpp"
#include "engine/tiled/steps.hpp"
#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "packed_turns.hpp"
#include "stepped.hpp"

namespace gridlock {

namespace {

/// Disks on a device leave their places in memory slowly; the machine sorts them for as long as many steps take.
constexpr std::uint64_t steps_between_sorts_on_device = 2000;

std::vector<std::uint32_t> all_tiles(Tiling const& tiling) {
  std::vector<std::uint32_t> tiles(tiling.tiles().size());
  std::iota(tiles.begin(), tiles.end(), 0U);
  return tiles;
}

/// Returns the disks of a state in the order of memory: by cell, tile by tile.
HotDisks disks_in_order(State const& state, CellLayout const& layout, Tiling const& tiling) {
  return HotDisks(state, tiled::CellOfTurn(layout, tiling, all_tiles(tiling)).order(state.agents.size(), [&](auto i) {
    return position(state.agents, i);
  }));
}

/// Takes steps on the cores of the processor.
class StepsOnCores final : public tiled::StepTaker {
 public:
  StepsOnCores(HotDisks&& disks, tiled::TurnRule const& rule, CellLayout const& layout, Tiling const& tiling,
               std::vector<Tiling::Round> const& rounds, ThreadPool& threads)
      : steps_(std::move(disks), rule, layout, tiling, {.end_column = layout.columns(), .end_row = layout.rows()},
               all_tiles(tiling)),
        rounds_(rounds),
        threads_(threads) {}

  void take_step(std::uint64_t step, Counters& counters) override {
    steps_.begin_step(step);
    for (Tiling::Round const& round : rounds_) {
      threads_.for_each(round.size(), [&](std::size_t part) { steps_.take_part(round[part]); });
    }
    CountersOfStep of_step;
    for (tiled::TileResult& result : steps_.results()) {
      // Disks too fast for their tile go in the order of tiles, because one may change the turn of the next.
      for (std::uint32_t const i : result.not_local) steps_.take_late(i, result);
      result.not_local.clear();
      of_step.add(result.counters);
      result.counters = {};
    }
    of_step.add_to(counters);
  }

  [[nodiscard]] std::optional<tiled::TooFast> too_fast() const override {
    for (tiled::TileResult const& result : steps_.results()) {
      if (result.too_fast) return result.too_fast;
    }
    return std::nullopt;
  }

  void write_back(State& state) override { steps_.disks().write_back(state); }

 private:
  tiled::Steps steps_;
  std::vector<Tiling::Round> const& rounds_;
  ThreadPool& threads_;
};

}  // namespace

EngineRecord tiled_record() {
  return {.name = "tiled",
          .documentation = "the same moves in an order that all cores can share",
          .uses_threads = true,
          .uses_device = true,
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
    : settings_(settings),
      is_on_device_(device_of(settings.device) == Device::gpu),
      duration_(step_duration(settings, state)),
      box_(state.box),
      thread_pool_(is_on_device_ ? 1 : settings.threads) {
  require_room_for_turns(settings, state);
  lay_out(state);
  if (!is_on_device_) return;
  require_device();
  std::size_t const disks = state.agents.size();
  require_room_on_device(disks, "disks", tiled::bytes_on_device(disks, layout_, tiling_));
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
    std::unique_ptr<tiled::StepTaker> const steps = step_taker(state);
    std::uint64_t const max_steps = is_on_device_ ? steps_between_sorts_on_device : tiled::steps_between_sorts;
    for (std::uint64_t n = 0; n < max_steps && is_before_stop() && !is_stopped; ++n) {
      steps->take_step(state.clock.step, counters);
      if (std::optional<tiled::TooFast> const disk = steps->too_fast()) {
        steps->write_back(state);
        throw_long_substep(state, disk->row_in_state, disk->displacement);
      }
      ++state.clock.step;
      state.clock.time += duration_;
      is_stopped = stop_condition.stops_here();
    }
    steps->write_back(state);
  }
}

std::unique_ptr<tiled::StepTaker> TiledEngine::step_taker(State const& state) {
  tiled::TurnRule const rule = rule_of(state);
  HotDisks disks = disks_in_order(state, layout_, tiling_);
  if (!is_on_device_) {
    return std::make_unique<StepsOnCores>(std::move(disks), rule, layout_, tiling_, rounds_, thread_pool_);
  }
  set_speeds(rule.heading, disks.all());
  return tiled::steps_on_device(disks, rule, layout_, tiling_, settings_.threads);
}

}  // namespace gridlock
