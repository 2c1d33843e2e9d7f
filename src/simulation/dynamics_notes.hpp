#pragma once

#include <optional>

#include "core/disks_overview.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/event.hpp"

namespace gridlock {

// Notes on the thermostat, propulsion, collisions and gravity of a run, before it begins.

/// Returns the motion of a free disk of the mean mass, in diameters of the smallest.
std::optional<Event> motion_by_thermostat(ThermostatSettings const& settings, Disks const& disks);

/// Returns how far self-propelled disks go, in diameters of the smallest, and how far a step or an interval is from
/// motion in continuous time. Contract: a thermostat is resolved.
std::optional<Event> motion_by_propulsion(EngineSettings const& settings, DisksOverview const& disks);

/// Throws Error for headings that turn by so large an angle that it cannot be told modulo a full turn.
void require_countable_turns(EngineSettings const& settings, DisksOverview const& disks);

/// Returns a note where collisions may come without end. With e of 0.95 or more that takes more disks than runs have.
std::optional<Event> may_collapse(CollisionSettings const& collisions);

/// Returns a note where contacts last so long that a twentieth of the collisions, or more, lose no energy, if disks
/// collide as often as in equilibrium at the temperature of the thermostat or of the start.
std::optional<Event> lasting_contacts(EngineSettings const& settings, State const& state);

/// Throws Error for disks that would fall without end, ever faster, or that fall through far more than a million
/// diameters in a time step.
void require_floor(EngineSettings const& settings, State const& state);

/// Return the kind that makes a setting of `[thermostat]` or `[potential]` unused, as TOML; empty where it is used.
std::string unused_of_thermostat(ThermostatKind kind, std::string_view key);
std::string unused_of_potential(PairPotential kind, std::string_view key);

/// Errors: Error for the length of a run in collisions, which soft disks do not have.
void require_counted_collisions(EngineSettings const& settings, RunSettings const& run);

/// Errors: Error for the viscosity, or for free flights, of disks that do not fly freely between collisions one by one.
void require_free_flight(EngineSettings const& settings, ObserveSettings const& observe);

/// Errors: Error for observables along x in a flow or an oblique box, where the images above are shifted.
void require_places_along_x(Configuration const& configuration);

/// Errors: Error for a run of steps whose engine knows rectangles only, behind a stage that leaves a tilt.
void require_known_tilt(Configuration const& configuration);
/// Returns a note where soft disks move with another potential than that of the stages before.
std::optional<Event> other_potential(Configuration const& configuration);

}  // namespace gridlock
