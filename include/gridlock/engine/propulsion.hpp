#pragma once

/// \file
/// Self-propelled disks: each swims along a heading of its own, which turns at random.
///
/// ```cpp
/// #include "gridlock/engine/engine.hpp"
/// #include "gridlock/lattice/start.hpp"
///
/// State state = make_start(Box(1.0, 1.0, Edge::periodic), {.count = 100, .packing_fraction = 0.3}, 1);
/// Counters counters;
/// PropulsionSettings const propulsion{.speed = 1.0, .rotational_diffusion = 0.5};
/// make_engine({.kind = "tiled", .propulsion = propulsion}, state)->advance(state, counters, {.step = 100});
/// ```

#include "gridlock/core/setting.hpp"

namespace gridlock {

/// The settings `[propulsion]`. A heading turns by √(2 D_R Δt) ξ in every step Δt of `stepped` and `tiled`, and at
/// every kick of the Brownian thermostat of `exact`; ξ is a normal number. docs/explanation/active.md says what disks
/// do.
struct PropulsionSettings {
  double speed = 0.0;                 ///< v₀; 0: disks do not propel themselves
  double rotational_diffusion = 0.0;  ///< D_R

  [[nodiscard]] bool is_on() const { return speed > 0.0; }
};
void describe(PropulsionSettings& settings, SettingVisitor& visitor);

/// The width √(2 D_R Δt) of the turns of headings, which are Δt apart.
double turn_width(PropulsionSettings const& settings, double duration);

}  // namespace gridlock
