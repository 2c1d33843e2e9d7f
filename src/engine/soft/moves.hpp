#pragma once

#include <cstdint>

#include "engine/headings.hpp"
#include "engine/soft/disks.hpp"
#include "engine/soft/lists.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::soft {

/// How disks move in a time step of length dt, with the force F of their places.
///
/// newton:     velocity Verlet (Swope et al. 1982, doi:10.1063/1.442716)
/// langevin:   BAOAB (Leimkuhler and Matthews 2013, doi:10.1093/amrx/abs010)
/// overdamped: r += F dt/(mγ) + v₀ n dt + √(2 kT dt/(mγ)) ξ (Ermak and McCammon 1978, doi:10.1063/1.436761)
///
/// In a flow γ̇ y along x, velocities and friction are relative to the flow where the disk is.
struct MoveRule {
  Box box;
  double duration;  ///< dt
  ThermostatKind thermostat;
  double friction;     ///< γ
  double temperature;  ///< kT
  double keep;         ///< e^(−γ dt), the part of a velocity that friction leaves
  std::uint64_t seed;
  HeadingRule heading;
  double shear_rate;  ///< γ̇ of the flow
  double strain;      ///< γ̇ times the time since the lists were made
};
/// Contract: a resolved thermostat.
MoveRule move_rule(EngineSettings const& settings, State const& state);

/// Sets the kicks and noises of all disks, which depend on their masses, and the velocities of disks without inertia.
void prepare(MoveRule const& rule, Disks& disks);

/// The longest ways of some disks.
struct LongestWays {
  double squared_step = 0.0;   ///< square of the longest path in this step; infinite if one is not a number
  std::size_t row = 0;         ///< the disk of this path
  double squared_drift = 0.0;  ///< square of the largest distance from where the lists were made

  void add(LongestWays const& other);
};

/// Moves the disks of a band, up to the place where the forces are to be computed.
LongestWays move(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks);

/// Ends the step of the disks of a band with the forces at their new places.
void end_step(MoveRule const& rule, Band const& band, Disks& disks);

}  // namespace gridlock::soft
