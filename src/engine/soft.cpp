#include "soft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "engine/soft/energy_guard.hpp"
#include "engine/soft/system.hpp"
#include "engine/stepped.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {

namespace {

/// Below this share of their contact distance, disks with an unbounded potential would be shot away.
constexpr double smallest_distance = 0.8;

void require_step(EngineSettings const& settings) {
  if (std::isfinite(settings.time_step) && settings.time_step > 0.0) return;
  throw Error({.what = fmt::format("the time step is {}, not a positive number", settings.time_step),
               .hint = "a usual value for soft disks is 0.005 to 0.05",
               .key = "engine.time_step"});
}

void require_periodic(Box const& box) {
  if (box.is_periodic()) return;
  throw Error({.what = fmt::format("the engine \"soft\" has no walls, and the box is {}", edges_in_words(box)),
               .hint = "use box.edge = \"periodic\"; fixed disks in a row make a wall (species with fixed = true)",
               .key = "box.edge"});
}

/// Errors: Error for a flow that fixed disks or swimmers would have to follow, or that carries disks too far in a step.
void require_flow(EngineSettings const& settings, State const& state) {
  if (!settings.flow.exists()) return;
  auto const refuse = [](std::string what, std::string hint, char const* key) {
    throw Error({.what = std::move(what), .hint = std::move(hint), .key = key});
  };
  if (std::size_t const fixed = count_of_fixed(state.agents); fixed > 0) {
    refuse(fmt::format("{} disks are fixed, and the flow would carry them along", fixed),
           "leave [flow] out, or let all species move", "flow.shear_rate");
  }
  if (settings.propulsion.is_on()) {
    refuse("disks propel themselves, and the flow would turn their headings, which the engine \"soft\" does not know",
           "use propulsion.speed = 0 in a flow", "propulsion.speed");
  }
  double const way = std::abs(settings.flow.shear_rate) * state.box.height() * step_duration(settings, state);
  double const longest = 0.25 * state.box.width();
  if (way <= longest) return;
  refuse(
      fmt::format("the flow carries disks as far as {:.3g} in one time step, more than a quarter of the width {:.6g}",
                  way, state.box.width()),
      fmt::format("use a shorter engine.time_step, such as {:.1g}", 0.5 * settings.time_step * longest / way),
      "flow.shear_rate");
}

void require_mobile_swimmers(EngineSettings const& settings, State const& state) {
  std::size_t const fixed = count_of_fixed(state.agents);
  if (!settings.propulsion.is_on() || fixed == 0) return;
  throw Error({.what = fmt::format("{} disks are fixed, and in the engine \"soft\" every disk swims", fixed),
               .hint = "use engine.kind = \"exact\" with thermostat.kind = \"brownian\", where fixed disks stay",
               .key = "propulsion.speed"});
}

/// Errors: Error for a time step in which a drag changes velocities so much that the steps might amplify them.
void require_gentle_drag(EngineSettings const& settings, State const& state) {
  if (!settings.pair_drag.exists()) return;
  // A disk among six of its size loses at most nine times as much; twice its velocity would be too much.
  constexpr double max_share = 0.2;
  auto const masses = state.agents.column<Mass>();
  double const lightest = *std::ranges::min_element(masses);
  double const share = settings.pair_drag.coefficient * step_duration(settings, state) / lightest;
  if (share <= max_share) return;
  throw Error(
      {.what = fmt::format("in one time step the drag of one neighbour would change the velocity of the lightest disk "
                           "by {:.3g} of the relative velocity, more than {}",
                           share, max_share),
       .hint = fmt::format("use a shorter engine.time_step, such as {:.1g}, or a lower pair_drag.coefficient",
                           0.5 * settings.time_step * max_share / share),
       .key = "pair_drag.coefficient"});
}

/// Throws Error for the nearest two disks if they overlap so much that an unbounded potential would shoot them away.
void require_small_overlaps(PotentialSettings const& potential, State const& state) {
  Disks const& disks = state.agents;
  if (is_bounded(potential.kind) || disks.size() < 2) return;
  PairLaw const law(potential);
  bool const is_of_table = potential.kind == PairPotential::table;
  double const smallest = is_of_table ? law.table().first_distance() : smallest_distance;
  auto const radius = disks.column<Radius>();
  PointPairs const pairs = find_pairs_of_disks(
      state.box, {.factor = smallest},
      {.x = disks.column<X>().data(), .y = disks.column<Y>().data(), .count = disks.size()}, radius);
  double nearest = std::numeric_limits<double>::infinity();
  std::size_t worst = 0;
  auto const ratio_of = [&](std::size_t k) {
    std::uint32_t const i = pairs.first()[k];
    std::uint32_t const j = pairs.second()[k];
    return std::sqrt(squared_length(state.box.displacement(position(disks, i), position(disks, j)))) /
           (radius[i] + radius[j]);
  };
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (ratio_of(k) >= nearest) continue;
    nearest = ratio_of(k);
    worst = k;
  }
  if (pairs.size() == 0) return;
  if (is_of_table) {
    throw Error({.what = fmt::format("{} pairs of disks are nearer than the first distance {:.6g} of the table of the "
                                     "potential; disks {} and {} are at {:.3g}",
                                     pairs.size(), smallest, disks.ids()[pairs.first()[worst]],
                                     disks.ids()[pairs.second()[worst]], nearest),
                 .hint = "begin the table nearer, or a [[protocol]] with stage = \"quench\", or start without overlaps",
                 .key = "disks"});
  }
  throw Error({.what = fmt::format(
                   "{} pairs of disks are nearer than {} of the sum of their radii; disks {} and {} are "
                   "at {:.3g}, where the potential \"{}\" has the energy {:.3g}",
                   pairs.size(), smallest, disks.ids()[pairs.first()[worst]], disks.ids()[pairs.second()[worst]],
                   nearest, to_text(potential.kind), law.energy(nearest * nearest, 1.0)),
               .hint = "begin a [[protocol]] with stage = \"quench\", or start from a lattice or random points without "
                       "overlaps",
               .key = "disks"});
}

void require_soft_start(EngineSettings const& settings, State const& state) {
  require_step(settings);
  require_disks(state.agents.size());
  require_periodic(state.box);
  validate(state, {.overlap = std::numeric_limits<double>::infinity()});
  require_mobile_swimmers(settings, state);
  require_flow(settings, state);
  require_gentle_drag(settings, state);
  static_cast<void>(soft::list_reach(settings.potential, state.box, radius_range(state.agents)));
  require_small_overlaps(settings.potential, state);
}

std::string_view unused_in_soft(EngineSettings const& /*settings*/, std::string_view setting) {
  bool const is_used = setting == "kind" || setting == "time_step" || setting == "speed" || setting == "threads";
  return is_used ? "" : "kind";
}

}  // namespace

EngineRecord soft_record() {
  return {.name = "soft",
          .documentation = "lets disks repel or attract each other by a [potential]",
          .uses_threads = true,
          .has_potential = true,
          .has_oblique_boxes = true,
          .bytes_per_disk = 480.0,
          .bytes_per_disk_of_checkpoint = 19.0,
          .unused_because_of = unused_in_soft,
          .cost_of_move = [](EngineSettings const& /*settings*/, State const& /*state*/) { return 1.0; },
          .make = [](EngineSettings const& settings, State const& state) -> std::unique_ptr<Engine> {
            return std::make_unique<SoftEngine>(settings, state);
          }};
}

SoftEngine::SoftEngine(EngineSettings const& settings, State const& state)
    : settings_(settings), duration_(step_duration(settings, state)), pool_(settings.threads) {
  require_soft_start(settings_, state);
  settings_.thermostat = resolved(settings.thermostat, state);
}

void SoftEngine::require_valid(State const& state) const { require_soft_start(settings_, state); }

std::vector<Count> SoftEngine::counts(State const& /*state*/, Counters const& counters) const {
  return {{"moves", counters.moves}};
}

void SoftEngine::advance(State& state, Counters& counters, StopCondition const& stop_condition) {
  if (stop_condition.is_reached(state.clock, counters.pair_collisions)) return;
  Clock const clock_before = state.clock;
  Counters const counters_before = counters;
  soft::System system(settings_, state, pool_, skin_);
  soft::EnergyGuard guard(settings_, system);
  try {
    while (!stop_condition.is_reached(state.clock, counters.pair_collisions)) {
      system.take_step(state.clock.step);
      ++state.clock.step;
      state.clock.time += duration_;
      counters.moves += state.agents.size();
      guard.look(state.clock.step, system);
      if (stop_condition.stops_here()) break;
    }
  } catch (RunFailure const&) {
    state.clock = clock_before;
    counters = counters_before;
    throw;
  }
  state.box = system.box();
  system.disks().write_back(state);
}

}  // namespace gridlock
