#pragma once

#include <cstddef>
#include <optional>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// The kinetic temperature kT, in energy units.
///
///     walls: kT = K/N        periodic: kT = (K − P²/2M) / (N − 1)
///
/// K is the kinetic energy, P the total momentum and M the total mass. Two degrees of freedom per agent carry kT/2
/// each; a periodic box keeps P for ever, so the motion of the centre of mass is no thermal motion and takes two of
/// them away. Absent for no agents, and for a single one in a periodic box. Cost: one or two passes over the agents.
/// Contract: the agents have a mass and a velocity.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4.
std::optional<double> temperature(Box const& box, AgentsView const& agents);
inline std::optional<double> temperature(State const& state) { return temperature(state.box, state.agents); }

/// The same of so many agents with such sums.
std::optional<double> temperature_between_walls(std::size_t agents, double kinetic_energy);
std::optional<double> periodic_temperature(std::size_t agents, double kinetic_energy, Vector momentum, double mass);

}  // namespace gridlock
