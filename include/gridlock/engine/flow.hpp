#pragma once

/// \file
/// Steady shear: soft disks in a flow along x whose speed grows with y.
///
/// ```cpp
/// #include "gridlock/engine/engine.hpp"
/// #include "gridlock/lattice/start.hpp"
///
/// DisksSettings const disks{.count = 160, .packing_fraction = {}, .radius = 0.5, .start = StartKind::uniform};
/// State state = make_start(Box(12.0, 12.0, Edge::periodic), disks, 1);
/// Counters counters;
/// ThermostatSettings const drag{.kind = ThermostatKind::overdamped, .temperature = 0.0, .friction = 1.0};
/// EngineSettings const sheared{
///     .kind = "soft", .time_step = 0.1, .thermostat = drag, .flow = {.shear_rate = 1e-3}};
/// make_engine(sheared, state)->advance(state, counters, {.time = 10.0});
/// ```

#include "gridlock/core/setting.hpp"

namespace gridlock {

/// The settings `[flow]`, which the engine `soft` knows: a flow with the velocity u = γ̇ y along x, γ̇ = `shear_rate`,
/// between periodic edges that move with it: box.tilt grows by γ̇ in a unit of time (Lees and Edwards 1972,
/// doi:10.1088/0022-3719/5/15/006). Velocities of disks, friction and kinetic energy are relative to the flow
/// (Evans and Morriss 1984, doi:10.1103/PhysRevA.30.1528).
struct FlowSettings {
  double shear_rate = 0.0;  ///< per time; below 0 the flow goes the other way

  [[nodiscard]] bool exists() const { return shear_rate != 0.0; }
};
void describe(FlowSettings& settings, SettingVisitor& visitor);

}  // namespace gridlock
