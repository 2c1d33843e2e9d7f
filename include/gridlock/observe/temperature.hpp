#pragma once

#include <optional>

#include "gridlock/core/state.hpp"

namespace gridlock {

/// The kinetic temperature kT, in energy units.
///
///     walls: kT = K/N        periodic: kT = (K − P²/2M) / (N − 1)
///
/// K is the kinetic energy, P the total momentum and M the total mass. Two degrees of freedom per disk carry kT/2 each;
/// a periodic box keeps P for ever, so the motion of the centre of mass is no thermal motion and takes two of them away.
/// Absent for no disks, and for a single one in a periodic box. Cost: one or two passes over the disks.
/// Source: D. Frenkel & B. Smit, Understanding Molecular Simulation (2002), chapter 4.
std::optional<double> temperature(State const& state);

}  // namespace gridlock
