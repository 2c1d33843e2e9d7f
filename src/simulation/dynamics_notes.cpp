#include "simulation/dynamics_notes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "core/temperature.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/protocol/settings.hpp"
#include "simulation/expected_work.hpp"

namespace gridlock {

namespace {

/// The relative error of self-diffusion at a packing fraction of 0.5, for a path of one diameter between two draws: it
/// is linear in the path (docs/explanation/thermostats.md).
constexpr double error_per_flight = 0.4;

double time_between_turns(EngineSettings const& settings, DisksOverview const& disks) {
  bool const has_steps = engine_record(settings.kind).has_time_step;
  return has_steps ? step_duration(settings, disks.radii.smallest) : settings.thermostat.interval.value_or(0.0);
}

}  // namespace

std::optional<Event> motion_by_thermostat(ThermostatSettings const& settings, Disks const& disks) {
  if (settings.kind == ThermostatKind::none || settings.has_friction() || disks.empty()) return std::nullopt;
  auto const masses = disks.column<Mass>();
  auto const first = std::ranges::find_if(masses, [](double mass) { return !is_fixed(mass); });
  if (first == masses.end()) return std::nullopt;
  bool const are_unlike = std::ranges::any_of(masses, [&](double m) { return !is_fixed(m) && m != *first; });
  BrownianScales const scales = brownian_scales(settings, mean_mass(disks), 2.0 * radius_range(disks).smallest);
  return Event{.kind = EventKind::thermostat,
               .key = "thermostat.interval",
               .values = {{"kind", std::string(to_text(settings.kind))},
                          {"temperature", *settings.temperature},
                          {"are_unlike", std::uint64_t{are_unlike}},
                          {"diffusion", scales.diffusion},
                          {"draws", scales.kicks_of_sigma2},
                          {"flight", scales.flight},
                          {"error_percent", 100.0 * error_per_flight * scales.flight}}};
}

std::optional<Event> may_collapse(CollisionSettings const& collisions) {
  double const lowest = collisions.lowest();
  if (lowest >= 0.95 || collisions.contact_time > 0.0) return std::nullopt;
  return Event{.kind = EventKind::losing_energy, .key = "collisions.contact_time", .values = {{"restitution", lowest}}};
}

std::optional<Event> lasting_contacts(EngineSettings const& settings, State const& state) {
  constexpr double noted_share = 0.05;
  CollisionSettings const& collisions = settings.collisions;
  if (!collisions.lose_energy() || !(collisions.contact_time > 0.0)) return std::nullopt;
  auto const count = static_cast<double>(state.agents.size() - count_of_fixed(state.agents));
  if (count == 0.0) return std::nullopt;
  double const temperature = settings.thermostat.temperature.value_or(kinetic_energy(state.agents) / count);
  double const diameter = 2.0 * radius_range(state.agents).largest;
  double const density = count / state.box.area();
  double const filled = packing_fraction_of(state);
  // The rate of Enskog with the contact value of Henderson (1975, doi:10.1080/00268977500102511).
  double const contact_value = (1.0 - 7.0 * filled / 16.0) / ((1.0 - filled) * (1.0 - filled));
  double const rate =
      2.0 * diameter * density * contact_value * std::sqrt(std::numbers::pi * temperature / mean_mass(state.agents));
  double const share = -std::expm1(-2.0 * rate * collisions.contact_time);
  if (share < noted_share) return std::nullopt;
  return Event{.kind = EventKind::lasting_contacts,
               .key = "collisions.contact_time",
               .values = {{"percent", 100.0 * share}, {"mean_free_time", 1.0 / rate}}};
}

void require_floor(EngineSettings const& settings, State const& state) {
  constexpr double max_falls_in_step = 1e6;
  double const gravity = std::sqrt(squared_length(settings.gravity.acceleration()));
  double const fall = std::sqrt(2.0 * 2.0 * radius_range(state.agents).smallest / gravity);
  if (gravity > 0.0 && step_duration(settings, state) > max_falls_in_step * fall) {
    throw Error(
        {.what = fmt::format("a gravity of {:.6g} lets a disk fall through its diameter in {:.3g}, while a time "
                             "step lasts {:.3g}: a run would be bounces without end",
                             gravity, fall, step_duration(settings, state)),
         .hint = "use a weaker gravity, or a shorter engine.time_step",
         .key = "gravity"});
  }
  // Collisions of disks keep their common motion, which only a bath, or what never moves, can stop.
  bool const has_obstacles = !settings.walls.empty() || count_of_fixed(state.agents) > 0;
  bool const is_held =
      settings.thermostat.kind != ThermostatKind::none || (settings.collisions.lose_energy() && has_obstacles);
  auto const refuse = [&](std::string const& axis, double gravity) {
    throw Error(
        {.what = fmt::format("gravity.{} = {} along periodic edges: the disks would fall without end, ever faster",
                             axis, gravity),
         .hint =
             fmt::format("use walls along this axis, a thermostat, or losses with fixed disks or walls inside the box"),
         .key = fmt::format("gravity.{}", axis)});
  };
  if (is_held) return;
  if (settings.gravity.x != 0.0 && state.box.is_periodic_x()) refuse("x", settings.gravity.x);
  if (settings.gravity.y != 0.0 && state.box.is_periodic_y()) refuse("y", settings.gravity.y);
}

void require_countable_turns(EngineSettings const& settings, DisksOverview const& disks) {
  constexpr double max_width = 100.0;
  if (!settings.propulsion.is_on() || disks.count == 0) return;
  double const duration = time_between_turns(settings, disks);
  double const width = turn_width(settings.propulsion, duration);
  if (width <= max_width) return;
  throw Error(
      {.what = fmt::format("headings would turn by about {:.3g} radians at once, more than {}", width, max_width),
       .hint = fmt::format("use a rotational diffusion below {:.3g}; above {:.3g} headings are random at every "
                           "turn",
                           0.5 * max_width * max_width / duration, 0.5 * 10.0 / duration),
       .key = "propulsion.rotational_diffusion"});
}

std::optional<Event> motion_by_propulsion(EngineSettings const& settings, DisksOverview const& disks) {
  PropulsionSettings const& propulsion = settings.propulsion;
  if (!propulsion.is_on() || disks.count == 0) return std::nullopt;
  bool const has_steps = engine_record(settings.kind).has_time_step;
  double const duration = time_between_turns(settings, disks);
  double const diameter = 2.0 * disks.radii.smallest;
  return Event{.kind = EventKind::propulsion,
               .key = "propulsion.speed",
               .values = {{"duration", std::string(has_steps ? "a time step" : "thermostat.interval")},
                          {"rotational_diffusion", propulsion.rotational_diffusion},
                          {"persistence", propulsion.rotational_diffusion > 0.0
                                              ? propulsion.speed / propulsion.rotational_diffusion / diameter
                                              : 0.0},
                          {"way", propulsion.speed * duration / diameter},
                          {"turn", turn_width(propulsion, duration)}}};
}

std::string unused_of_thermostat(ThermostatKind kind, std::string_view key) {
  bool const is_used = key == "thermostat.kind" || (key == "thermostat.temperature" && kind != ThermostatKind::none) ||
                       (key == "thermostat.rate" && kind == ThermostatKind::andersen) ||
                       (key == "thermostat.interval" && kind == ThermostatKind::brownian) ||
                       (key == "thermostat.friction" && ThermostatSettings{.kind = kind}.has_friction());
  return is_used ? "" : fmt::format("thermostat.kind = \"{}\"", to_text(kind));
}

std::string unused_of_potential(PairPotential kind, std::string_view key) {
  bool const is_cut = kind == PairPotential::inverse_power || kind == PairPotential::lennard_jones;
  bool const is_row = key == "potential.distances" || key == "potential.energies" || key == "potential.file";
  bool const is_used = key == "potential.kind" || key == "potential.energy" || (key == "potential.cutoff" && is_cut) ||
                       (key == "potential.exponent" && kind == PairPotential::inverse_power) ||
                       (is_row && kind == PairPotential::table);
  return is_used ? "" : fmt::format("potential.kind = \"{}\"", to_text(kind));
}

void require_counted_collisions(EngineSettings const& settings, RunSettings const& run) {
  EngineRecord const& engine = engine_record(settings.kind);
  if (!engine.has_potential || !run.collisions_per_disk) return;
  throw Error(
      {.what = fmt::format("the disks of the engine \"{}\" do not collide, so the length of a run cannot be given "
                           "in collisions",
                           engine.name),
       .hint = "give run.steps or run.time",
       .key = "run.collisions_per_disk"});
}

void require_free_flight(EngineSettings const& settings, ObserveSettings const& observe) {
  if (observe.viscosity_lag == 0 && !observe.free_flights) return;
  bool const is_viscosity = observe.viscosity_lag > 0;
  auto const refuse = [&](std::string const& by, char const* hint) {
    throw Error({.what = fmt::format("{} is measured between collisions in free flight, and {}",
                                     is_viscosity ? "observe.viscosity_lag" : "observe.free_flights", by),
                 .hint = hint,
                 .key = is_viscosity ? "observe.viscosity_lag" : "observe.free_flights"});
  };
  constexpr std::uint64_t least_lag = 3;  // its slope is that of the last two thirds of the lags
  if (is_viscosity && observe.viscosity_lag < least_lag) {
    throw Error({.what = fmt::format("observe.viscosity_lag is {}, too short for a slope", observe.viscosity_lag),
                 .hint = "use 12 mean free times, at least 3 samples; 0 for no viscosity",
                 .key = "observe.viscosity_lag"});
  }
  if (!engine_record(settings.kind).has_free_flight) {
    refuse(fmt::format("the engine \"{}\" has no free flight", settings.kind),
           "use engine.kind = \"exact\"; the stress of \"soft\" is in its series, for gridlock.shear_viscosity()");
  }
  if (settings.thermostat.kind != ThermostatKind::none) refuse("a thermostat kicks the disks", "take [thermostat] out");
  if (settings.gravity.exists()) refuse("gravity accelerates the disks", "take [gravity] out");
  if (!settings.walls.empty()) refuse("disks hit walls inside the box", "take [[walls]] out");
  if (settings.collisions.lose_energy() && is_viscosity) {
    refuse("collisions that lose energy leave no equilibrium, whose fluctuations it needs",
           "use collisions.restitution = 1");
  }
}

void require_places_along_x(Configuration const& configuration) {
  ObserveSettings const& observe = configuration.observe;
  bool const flows = configuration.engine.flow.exists();
  if (!flows && configuration.box.tilt == 0.0) return;
  auto const refuse = [](char const* what, char const* hint, char const* key) {
    throw Error({.what = what, .hint = hint, .key = key});
  };
  if (observe.density_profile == ProfileAxes::x || observe.density_profile == ProfileAxes::both) {
    refuse(flows ? "a flow leaves no places along x, so there is no density profile along x"
                 : "an oblique box has no places along x, so there is no density profile along x",
           "use observe.density_profile = \"y\"", "observe.density_profile");
  }
  if (flows && observe.flux_line == FluxLine::vertical) {
    refuse("a flow carries the images of a vertical line away from it, so there is no flux through it",
           "use observe.flux_line = \"horizontal\"", "observe.flux_line");
  }
}

void require_known_tilt(Configuration const& configuration) {
  auto const& stages = configuration.protocol;
  EngineRecord const& engine = engine_record(configuration.engine.kind);
  auto const tilting = std::ranges::find_if(stages, tilts);
  if (engine.has_oblique_boxes || tilting == stages.end() || !takes_steps(configuration)) return;
  throw Error(
      {.what = fmt::format("the engine \"{}\" knows rectangles only, and the stage \"{}\" of the protocol leaves "
                           "a tilt",
                           engine.name, tilting->kind),
       .hint = "use engine.kind = \"exact\" or \"soft\", or give [run] no length",
       .key = "engine.kind"});
}

std::optional<Event> other_potential(Configuration const& configuration) {
  auto const& stages = configuration.protocol;
  EngineSettings const& engine = configuration.engine;
  if (stages.empty() || !leaves_overlaps(stages.back().kind) || !takes_steps(configuration)) return std::nullopt;
  if (!engine_record(engine.kind).has_potential) return std::nullopt;
  std::string const pressed = to_text(configuration.soft.potential);
  std::string const moved(to_text(engine.potential.kind));
  if (pressed == moved) return std::nullopt;
  return Event{
      .kind = EventKind::other_potential, .key = "potential.kind", .values = {{"protocol", pressed}, {"run", moved}}};
}

}  // namespace gridlock
