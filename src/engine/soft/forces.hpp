#pragma once

#include <cstddef>

#include "core/pair_law.hpp"
#include "engine/soft/disks.hpp"
#include "engine/soft/lists.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::soft {

/// The numbers that all forces of a state share.
struct ForceRule {
  PairPotential kind;
  PairLaw law;
  PairConstants constants;
  double period_x;
  double period_y;
  double shift;  ///< along x of the image above, in an oblique box
  /// Contact distance of all disks if their radii are equal; else 0.
  double sigma;
  /// Forces of pairs are rounded to a multiple of a common power of two by adding this number and taking it away again.
  /// Sums of up to 128 of them are then exact, so that they depend on no order: not on lists, threads or instructions.
  double rounding;
  /// Largest force over distance for which this holds.
  double max_push;
};

/// Returns a force rounded by such a number.
inline double rounded(double force, double rounding) { return (force + rounding) - rounding; }

/// Returns the rule for disks with these radii. With a drag between them forces are rounded less finely, so that there
/// is room for it.
ForceRule force_rule(PotentialSettings const& potential, Box const& box, RadiusRange const& radii,
                     bool has_drag = false);

/// Computes the forces on the disks of a band. Returns the largest push, force over distance, of a potential that is
/// not bounded; 0 for others.
using ComputeForces = double (*)(ForceRule const& rule, Band const& band, Disks& disks);

/// Returns the kernel for these instructions; all give the same bits, as a test verifies. Contract:
/// is_available(target).
ComputeForces forces_for(Target target, ForceRule const& rule);

}  // namespace gridlock::soft
