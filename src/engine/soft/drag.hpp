#pragma once

#include "engine/soft/disks.hpp"
#include "engine/soft/forces.hpp"
#include "engine/soft/lists.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::soft {

/// The drag between disks that touch, with velocities v of the disks and the flow:
///
///     all:    F_i = −k Σ_j (v_i − v_j)                   normal:   F_i = −k Σ_j ((v_i − v_j)·n) n
///
/// The force depends on the velocities, so a step evaluates it twice: with those at its beginning, and at its end with
/// those that the forces of the beginning lead to. It is then of the second order in the step, and a function of places
/// and velocities alone, so that no call of the engine has to remember it. Where a contact begins or ends the drag
/// jumps, with an error of the first order.
struct DragRule {
  PairDragSettings drag;
  double shear_rate;  ///< γ̇; across an edge it makes the difference of the velocities of two images
  /// Drags are rounded as forces are, ForceRule::rounding, so that their sums are exact too.
  double rounding;
  double largest_drag;  ///< along an axis, for which this holds
};

/// Returns the rule for disks whose forces are rounded so. Contract: the drag exists, and `forces` was made for it.
DragRule drag_rule(EngineSettings const& settings, ForceRule const& forces, RadiusRange const& radii);

/// Makes the drag see the velocities of the disks of a band as they are.
void take_velocities(Band const& band, Disks& disks);

/// Makes the drag see the velocities that the disks of a band would have after one more kick by their forces.
void predict_velocities(Band const& band, Disks& disks);

/// Adds the drags to the forces on the disks of a band, and returns the largest of a pair along an axis.
double add_drags(DragRule const& rule, Box const& box, Band const& band, Disks& disks);

/// Kicks the disks of a band by their forces and drags, and leaves the forces; returns the largest drag of a pair along
/// an axis.
double kick_with_drags(DragRule const& rule, Box const& box, Band const& band, Disks& disks);

}  // namespace gridlock::soft
