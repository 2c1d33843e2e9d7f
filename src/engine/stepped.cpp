#include "stepped.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>

#include "engine/headings.hpp"
#include "engine/hot_disks.hpp"
#include "grid/linked_grid.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/packed_layout.hpp"
#include "gridlock/grid/validate.hpp"
#include "packed_turns.hpp"
#include "turn.hpp"

namespace gridlock {

namespace {

void require_bounds(EngineSettings const& settings, DisksOverview const& all) {
  if (!(std::isfinite(settings.time_step) && settings.time_step > 0.0)) {
    throw Error({.what = fmt::format("the time step is {}, not a positive number", settings.time_step),
                 .hint = "the usual value is 0.1",
                 .key = "engine.time_step"});
  }
  if (settings.substeps == 0) {
    throw Error({.what = "a time step of 0 sub-steps goes nowhere",
                 .hint = "the paper's value is 5",
                 .key = "engine.substeps"});
  }
  require_disks(all.count);
}

std::string jump_text(LongSubstep const& disk) {
  return fmt::format("disk {} covers {:.6g} in one sub-step and could jump over a disk at contact distance {:.6g}",
                     disk.id, disk.displacement, disk.contact);
}

constexpr char const* jump_hint = "use a smaller engine.time_step or more engine.substeps";

void require_no_jumps(State const& some, DisksOverview const& all, double substep) {
  for (std::size_t i = 0; i < some.agents.size(); ++i) {
    double const squared_displacement = squared_length(velocity(some.agents, i)) * substep * substep;
    double const contact = some.agents.column<Radius>()[i] + all.radii.smallest;
    if (is_short(squared_displacement, contact)) continue;
    throw Error({.what = jump_text({some.agents.ids()[i], std::sqrt(squared_displacement), contact}),
                 .hint = jump_hint,
                 .key = "engine.time_step"});
  }
}

/// Throws Error for a small periodic box. Pairs collide along the vector to the nearest image; it is the image that was
/// hit as long as contact distance plus sub-step is less than half the box.
void require_room_for_images(Box const& box, DisksOverview const& all, double substep) {
  if (all.count < 2) return;
  double const shorter = box.shortest_period();
  double const needed = 2.0 * (2.0 * all.radii.largest + all.largest_speed * substep);
  if (needed <= shorter) return;
  throw Error({.what = fmt::format("a periodic box with a side of {:.6g} is too small: a disk could meet two images of "
                                   "another at once, which needs sides of at least {:.6g}",
                                   shorter, needed),
               .hint = "use more disks, a lower packing fraction, or walls",
               .key = "box"});
}

void require_moving_swimmers(EngineSettings const& settings, State const& some) {
  if (!settings.propulsion.is_on() || count_of_fixed(some.agents) == 0) return;
  throw Error({.what = fmt::format("{} disks are fixed, and under a rule with a time step every disk swims",
                                   count_of_fixed(some.agents)),
               .hint = "use engine.kind = \"exact\" with thermostat.kind = \"brownian\", where fixed disks stay",
               .key = "propulsion.speed"});
}

void require_short_ways(EngineSettings const& settings, State const& some, DisksOverview const& all) {
  require_moving_swimmers(settings, some);
  require_room_beside_walls(some, settings.walls);
  double const substep = step_duration(settings, all.radii.smallest) / static_cast<double>(settings.substeps);
  require_no_jumps(some, all, substep);
  require_room_for_images(some.box, all, substep);
}

}  // namespace

void require_disks(std::uint64_t count) {
  if (count > 0) return;
  throw Error({.what = "there are no disks to move", .hint = "give at least one", .key = "disks.count"});
}

void throw_long_substep(State const& state, std::size_t i, double displacement) {
  throw_long_substep(state.clock.step,
                     {.id = state.agents.ids()[i],
                      .displacement = displacement,
                      .contact = state.agents.column<Radius>()[i] + radius_range(state.agents).smallest});
}

void throw_long_substep(std::uint64_t step, LongSubstep const& disk) {
  throw RunFailure(fmt::format("step {}: {}\n  hint: {}", step, jump_text(disk), jump_hint));
}

void require_room_for_turns(EngineSettings const& settings, State const& state) {
  DisksOverview const all = overview_of(state.agents);
  require_bounds(settings, all);
  // No tolerance at walls: a disk that slides along a wall outside the box would be halted at every step.
  validate(state, {.overlap = rounding_of_contact(state)});
  require_short_ways(settings, state, all);
}

void require_room_for_turns_of(EngineSettings const& settings, State const& some, DisksOverview const& all,
                               RowProblems const& problems) {
  require_bounds(settings, all);
  problems.require_none(some.box);
  require_no_own_images(some.box, all.radii.largest);
  require_short_ways(settings, some, all);
}

CellLayout stepped_layout(EngineSettings const& settings, State const& state) {
  double const duration = step_duration(settings, state);
  if (settings.cells) {
    CellLayout const asked_for(state.box, *settings.cells, *settings.cells);
    if (settings.grid == GridKind::linked) return asked_for;
  }
  double const displacement = largest_speed(state.agents) * duration;
  // A quarter is added, since disks may become faster than the fastest at the start.
  if (settings.grid == GridKind::packed) return packed_layout(state.box, state.agents, 1.25 * displacement);
  double const cutoff = 2.0 * radius_range(state.agents).largest + displacement;
  return layout_for_cutoff(state.box, cutoff, state.agents.size());
}

namespace {

std::string_view unused_because_of(EngineSettings const& settings, std::string_view setting) {
  // The packed grid chooses its own cells, so `cells` has no effect with it.
  if (setting == "cells") return settings.grid == GridKind::linked ? "" : "grid";
  return setting == "audit_every" || setting == "threads" || setting == "device" ? "kind" : "";
}

/// Returns the cost of a move: few cells have many disks in each, and many cells take long to visit.
double cost_of_move(EngineSettings const& settings, State const& state) {
  // Cells and candidates of a move on a grid chosen from the sizes, and the cost of the rest of it in the same unit.
  constexpr double usual_cells = 9.0;
  constexpr double usual_candidates = 9.0;
  constexpr double rest_of_move = 10.0;
  if (settings.grid != GridKind::linked || !settings.cells) return 1.0;
  double const k = static_cast<double>(*settings.cells);
  double const cutoff = 2.0 * radius_range(state.agents).largest / std::min(state.box.width(), state.box.height());
  double const block = std::min(k, 3.0 + 2.0 * k * cutoff);
  double const cells = block * block;
  double const candidates = static_cast<double>(state.agents.size()) * cells / (k * k);
  return (rest_of_move + cells + candidates) / (rest_of_move + usual_cells + usual_candidates);
}

}  // namespace

EngineRecord stepped_record() {
  return {.name = "stepped",
          .documentation = "is the paper's rule, disk after disk",
          .bytes_per_disk = 223.0,
          .bytes_per_cell = 4.0,
          .unused_because_of = unused_because_of,
          .cost_of_move = cost_of_move,
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            return std::make_unique<SteppedEngine>(settings, state);
          }};
}

SteppedEngine::SteppedEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), box_(state.box) {
  require_room_for_turns(settings, state);
  layout_ = stepped_layout(settings, state);
}

void SteppedEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (state.box != box_) {
    box_ = state.box;
    layout_ = stepped_layout(settings_, state);
  }
  if (settings_.grid == GridKind::linked) {
    advance_on_lists(state, counters, stop_condition);
  } else {
    advance_packed(state, counters, stop_condition);
  }
}

template <class TakeTurn>
void SteppedEngine::take_turns(State& state, HotDisks& disks, Counters& counters, StopCondition const& stop_condition,
                               HeadingStep& of_step, TakeTurn take) const {
  double const smallest = radius_range(state.agents).smallest;
  double const substep = duration_ / static_cast<double>(settings_.substeps);
  HeadingRule const heading = heading_rule(settings_.propulsion, duration_, state.seed);
  set_speeds(heading, disks.all());
  while (!stop_condition.is_reached(state.clock, counters.pair_collisions)) {
    if (heading.is_on()) of_step = heading_step(heading, state.clock.step);
    for (std::size_t i = 0; i < disks.size(); ++i) {
      if (heading.is_on()) disks[i].velocity = turned_velocity(of_step, disks[i].id_index, disks[i].velocity);
      double const squared_speed = squared_length(disks[i].velocity);
      if (!is_short(squared_speed * substep * substep, disks[i].radius + smallest)) {
        disks.write_back(state);
        throw_long_substep(state, disks[i].row_in_state, std::sqrt(squared_speed) * substep);
      }
      take(i, squared_speed);
    }
    ++state.clock.step;
    state.clock.time += duration_;
    if (stop_condition.stops_here()) break;
  }
  disks.write_back(state);
}

void SteppedEngine::advance_on_lists(State& state, Counters& counters, StopCondition const& stop_condition) const {
  HotDisks disks(state, rows_in_order(state.agents.ids()));
  HeadingStep of_step{};
  RadiusRange const radii = radius_range(state.agents);
  Obstacles const walls = walls_of(settings_.walls, state.box, radii.largest);
  TurnView const view = disks.view(state.box, settings_, duration_, of_step, walls);
  auto grid = grid_of<LinkedGrid>(layout_, disks);
  Cutoff const cutoff(state.box, radii.largest, duration_, settings_.substeps);
  take_turns(state, disks, counters, stop_condition, of_step, [&](std::size_t i, double squared_speed) {
    double const distance = cutoff.of(disks[i].radius, squared_speed);
    int const columns = layout_.columns_within(distance);
    int const rows = layout_.rows_within(distance);
    int const cell = grid.cell_of(i);
    take_turn(view, i, counters, [&](Partner& partner) {
      grid.for_each_in_block(cell, columns, rows, [&](std::size_t j) { partner.consider(j); });
    });
    grid.move(i, disks[i].position);
  });
}

void SteppedEngine::advance_packed(State& state, Counters& counters, StopCondition const& stop_condition) const {
  HotDisks disks(state, rows_in_order(state.agents.ids()));
  HeadingStep of_step{};
  RadiusRange const radii = radius_range(state.agents);
  Obstacles const walls = walls_of(settings_.walls, state.box, radii.largest);
  TurnView const view = disks.view(state.box, settings_, duration_, of_step, walls);
  auto grid = grid_of<PackedGrid>(layout_, disks);
  PackedTurns turns(view, grid, radii, duration_);
  take_turns(state, disks, counters, stop_condition, of_step, [&](std::size_t i, double squared_speed) {
    if (turns.is_local(i, squared_speed)) {
      turns.take(turns.prepare(i), counters);
    } else {
      turns.take_any(i, counters);
    }
  });
}

}  // namespace gridlock
