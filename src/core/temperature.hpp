#pragma once

#include <cstddef>
#include <optional>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Returns the kinetic temperature kT, in energy units.
///
///     walls: kT = K/N        periodic: kT = (K − P²/2M) / (N − 1)
///     periodic along one axis, with the momentum P along it: kT = (K − P²/2M) / (N − ½)
///
/// K is the kinetic energy, P the total momentum and M the total mass. Two degrees of freedom per agent carry kT/2
/// each. Momentum along a periodic axis is conserved, so the motion of the centre of mass along it is not thermal, and
/// one degree of freedom less counts. Returns nothing for no agents, and for one in a periodic box. Cost: one or two
/// passes over the agents.
/// Contract: the agents have a mass and a velocity.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4.
std::optional<double> temperature(Box const& box, AgentsView const& agents);
inline std::optional<double> temperature(State const& state) { return temperature(state.box, state.agents); }

/// Return the temperature of `agents` agents from these sums.
std::optional<double> temperature_between_walls(std::size_t agents, double kinetic_energy);
std::optional<double> temperature_without_drift(Box const& box, std::size_t agents, double kinetic_energy,
                                                Vector momentum, double mass);

/// Returns the mean mass of the disks that move. Contract: some do.
double mean_mass(Disks const& disks);

}  // namespace gridlock
