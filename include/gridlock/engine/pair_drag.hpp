#pragma once

/// \file
/// Drag between soft disks that touch: grains that lose energy in their contacts.
///
/// ```cpp
/// #include "gridlock/engine/engine.hpp"
///
/// EngineSettings const grains{
///     .kind = "soft", .time_step = 0.02, .pair_drag = {.coefficient = 0.5, .direction = DragDirection::normal}};
/// ```

#include "gridlock/core/setting.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The part of the relative velocity that a drag slows down: all of it, or that along the line of centres alone.
enum class DragDirection { all, normal };

/// The settings `[pair_drag]`, which the engine `soft` knows. Two disks nearer than the sum of their radii feel the
/// forces ∓k (v_i − v_j), or ∓k ((v_i − v_j)·n) n with the line of centres n (Cundall and Strack 1979,
/// doi:10.1680/geot.1979.29.1.47). They keep the momentum and lose energy. In a flow velocities are those of the disks
/// with the flow. There is no noise, so the drag does not go with a temperature.
struct PairDragSettings {
  double coefficient = 0.0;  ///< k, mass over time; 0 is no drag
  DragDirection direction = DragDirection::all;

  [[nodiscard]] bool exists() const { return coefficient != 0.0; }
  /// Returns the force on a disk at r ≠ 0 from its partner, for the difference of its velocity and that
  /// of the partner. For the partner the same operations give the opposite to the last bit.
  [[nodiscard]] Vector force(Vector r, Vector difference) const {
    if (direction == DragDirection::all) return -coefficient * difference;
    return -(coefficient * dot(difference, r) / squared_length(r)) * r;
  }
};
void describe(PairDragSettings& settings, SettingVisitor& visitor);

}  // namespace gridlock
