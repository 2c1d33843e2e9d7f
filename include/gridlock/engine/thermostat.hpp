#pragma once

/// \file
/// Thermostats: colloids in a liquid, as hard disks whose velocities are drawn anew now and then.
///
/// ```cpp
/// #include "gridlock/engine/engine.hpp"
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 100, .packing_fraction = 0.5}, 1);
/// Counters counters;
/// ThermostatSettings const thermostat{.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 0.001};
/// make_engine({.kind = "exact", .thermostat = thermostat}, state)->advance(state, counters, {.time = 0.1});
/// ```

#include <optional>
#include <string_view>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/setting.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// How disks exchange energy with a bath. The engine `exact` knows andersen and brownian, `soft` the last two.
///
/// none:     they do not.
/// andersen: each disk alone gets a Maxwell velocity at random times, `rate` of them per unit of time (Andersen 1980,
///           doi:10.1063/1.439486). A free disk diffuses with D₀ = kT/(m · rate).
/// brownian: all disks get Maxwell velocities at the times 0, Δt, 2Δt … of the clock, Δt = `interval`: event-driven
///           Brownian dynamics (Scala, Voigtmann, De Michele 2007, doi:10.1063/1.2719190). A free disk diffuses with
///           D₀ = kT Δt/(2m).
/// langevin: m dv/dt = F − m γ v + noise, γ = `friction` (Leimkuhler and Matthews 2013, doi:10.1093/amrx/abs010). A
///           free disk diffuses with D₀ = kT/(m γ).
/// overdamped: m γ dr/dt = F + noise, Brownian dynamics without inertia (Ermak and McCammon 1978,
///           doi:10.1063/1.436761), with the same D₀. Disks have no velocities but those of their propulsion.
enum class ThermostatKind { none, andersen, brownian, langevin, overdamped };
/// Returns the word of a kind, as in thermostat.kind.
std::string_view to_text(ThermostatKind kind);

/// The settings `[thermostat]`. A Maxwell velocity has components of variance kT/m, and noise is normal; both are drawn
/// as a function of (seed, draw, Id): the same whatever else happens, on every machine and any number of threads.
struct ThermostatSettings {
  ThermostatKind kind = ThermostatKind::none;
  std::optional<double> temperature;  ///< kT; left out: the kinetic energy of a disk at the start
  std::optional<double> rate;         ///< per time; left out: √(kT/m)/σ, of the mean mass and the smallest diameter
  std::optional<double> interval;     ///< left out: 0.05 σ √(m/kT), of the mean mass and the smallest diameter
  std::optional<double> friction;  ///< γ, per time; left out: √(kT/m)/σ, of the mean mass and the smallest diameter

  /// Whether noise and friction act all the time.
  [[nodiscard]] bool has_friction() const {
    return kind == ThermostatKind::langevin || kind == ThermostatKind::overdamped;
  }
};
void describe(ThermostatSettings& settings, SettingVisitor& visitor);

/// Returns the settings with all that was left out filled in for the disks of a state.
/// Errors: Error under "thermostat.temperature" where the disks rest and no temperature is given, and under
/// "thermostat.interval" or "thermostat.rate" where a disk would fly less than 10⁻⁶ of its diameter between two kicks,
/// or the clock is too late to count them.
ThermostatSettings resolved(ThermostatSettings const& settings, State const& state);

/// Numbers that tell how far a thermostat is from Brownian motion, of a disk of mass m and diameter σ.
struct BrownianScales {
  double diffusion;        ///< D₀ of a free disk
  double flight;           ///< root mean square path between two kicks, along each axis, in σ
  double kicks_of_sigma2;  ///< kicks in σ²/D₀, the time of diffusion over a diameter
};
/// Returns them. Contract: resolved settings of andersen or brownian.
BrownianScales brownian_scales(ThermostatSettings const& settings, double mass, double diameter);

}  // namespace gridlock
