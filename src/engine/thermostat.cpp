#include "gridlock/engine/thermostat.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "core/magnitude.hpp"
#include "core/temperature.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// A flight of a twentieth of a diameter: the error of the coefficient of diffusion is a few percent in a dense system.
constexpr double default_flight = 0.05;

constexpr std::array<std::string_view, 5> kinds{"none", "andersen", "brownian", "langevin", "overdamped"};

/// Kicks that come so often that disks do not move between them would never end. `speed` is in diameters per time.
void require_countable_kicks(ThermostatSettings const& settings, double speed, double now) {
  constexpr double min_flight = 1e-6;
  constexpr double max_kicks = 0x1p52;
  bool const is_brownian = settings.kind == ThermostatKind::brownian;
  double const between = is_brownian ? *settings.interval : 1.0 / *settings.rate;
  if (speed * between >= min_flight && now / between <= max_kicks) return;
  throw Error(
      {.what = fmt::format("between two kicks, {:.3g} apart in time, a disk would fly {:.3g} of its diameter, and "
                           "the clock begins at {:.6g}: too many to count",
                           between, speed * between, now),
       .hint = is_brownian ? "use a longer interval" : "use a lower rate",
       .key = is_brownian ? "thermostat.interval" : "thermostat.rate"});
}

}  // namespace

void describe(ThermostatSettings& settings, SettingVisitor& visitor) {
  visit_enum(
      visitor,
      {.key = "kind",
       .documentation = "Whether disks exchange energy with a bath: not with \"none\"; in the engine exact each gets "
                        "new Maxwell velocities alone at random times with \"andersen\", all at once after every "
                        "interval with \"brownian\", which is event-driven Brownian dynamics; in the engine soft they "
                        "feel friction and noise with \"langevin\", and have no inertia with \"overdamped\"."},
      kinds, settings.kind);
  visitor.visit({.key = "temperature",
                 .unit = "energy",
                 .documentation = "kT of the bath: each component of a Maxwell velocity has the variance kT/m; 0 is "
                                  "friction without noise, for langevin and overdamped.",
                 .min = 0.0,
                 .max = max_magnitude,
                 .default_note = "the mean kinetic energy of a disk at the start"},
                settings.temperature);
  visitor.visit(
      {.key = "rate",
       .unit = "1 / time",
       .documentation = "andersen: new velocities of a disk per time; a free disk diffuses with kT/(m · rate).",
       .min = 0.0,
       .max = max_magnitude,
       .min_is_allowed = false,
       .default_note = "√(kT/m)/σ, of the mean mass and the smallest diameter"},
      settings.rate);
  visitor.visit(
      {.key = "interval",
       .unit = "time",
       .documentation =
           "brownian: time between two draws of all velocities; a free disk diffuses with kT · interval/(2m).",
       .min = 0.0,
       .max = max_magnitude,
       .min_is_allowed = false,
       .default_note = "0.05 σ √(m/kT), of the mean mass and the smallest diameter"},
      settings.interval);
  visitor.visit(
      {.key = "friction",
       .unit = "1 / time",
       .documentation = "langevin and overdamped: γ, friction over mass; a free disk diffuses with kT/(m · γ).",
       .min = 0.0,
       .max = max_magnitude,
       .min_is_allowed = false,
       .default_note = "√(kT/m)/σ, of the mean mass and the smallest diameter"},
      settings.friction);
}

std::string_view to_text(ThermostatKind kind) { return kinds[static_cast<std::size_t>(kind)]; }

ThermostatSettings resolved(ThermostatSettings const& settings, State const& state) {
  Disks const& disks = state.agents;
  ThermostatSettings full = settings;
  if (settings.kind == ThermostatKind::none || disks.empty()) return full;
  std::size_t const moving = disks.size() - count_of_fixed(disks);
  if (moving == 0) {
    throw Error({.what = "all disks are fixed, so the thermostat has nothing to move",
                 .hint = "let some species move, or leave [thermostat] out",
                 .key = "thermostat.kind"});
  }
  if (!full.temperature) full.temperature = kinetic_energy(disks) / static_cast<double>(moving);
  bool const is_cold = settings.temperature == 0.0;
  if (is_cold && !full.has_friction()) {
    throw Error({.what = fmt::format("a bath of temperature 0 stops all disks with thermostat.kind = \"{}\"",
                                     to_text(settings.kind)),
                 .hint = "use a temperature above 0; langevin and overdamped know friction without noise",
                 .key = "thermostat.temperature"});
  }
  if (is_cold && !full.friction) {
    throw Error({.what = "a bath of temperature 0 has no friction of its own",
                 .hint = "give thermostat.friction",
                 .key = "thermostat.friction"});
  }
  if (!(*full.temperature > 0.0) && !is_cold) {
    throw Error({.what = "the disks rest at the start, so the temperature of the thermostat is not known",
                 .hint = "give thermostat.temperature, or velocities.max above 0",
                 .key = "thermostat.temperature"});
  }
  double const diameter = 2.0 * radius_range(disks).smallest;
  double const speed = std::sqrt(*full.temperature / mean_mass(disks));
  if (!full.rate && full.kind == ThermostatKind::andersen) full.rate = speed / diameter;
  if (!full.interval && full.kind == ThermostatKind::brownian) full.interval = default_flight * diameter / speed;
  if (!full.friction && full.has_friction()) full.friction = speed / diameter;
  if (!full.has_friction()) require_countable_kicks(full, speed / diameter, state.clock.time);
  return full;
}

BrownianScales brownian_scales(ThermostatSettings const& settings, double mass, double diameter) {
  double const speed = std::sqrt(*settings.temperature / mass);
  bool const is_brownian = settings.kind == ThermostatKind::brownian;
  double const time = is_brownian ? *settings.interval : 1.0 / *settings.rate;
  double const diffusion = (is_brownian ? 0.5 : 1.0) * speed * speed * time;
  return {.diffusion = diffusion,
          .flight = speed * time / diameter,
          .kicks_of_sigma2 = diameter * diameter / (diffusion * time)};
}

}  // namespace gridlock
