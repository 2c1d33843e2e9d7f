#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::validation {

/// Disks of diameter 1 on stretched, shifted rows of a periodic square, Maxwell velocities without a common drift.
///
/// With √3/2 times as many columns as rows they stand in a crystal, with as many of both in rows too far apart to last,
/// which melt at once.
inline State rows_of_disks(std::uint64_t columns, std::uint64_t rows, double packing_fraction, std::uint64_t seed = 1) {
  std::uint64_t const n = columns * rows;
  double const side = std::sqrt(static_cast<double>(n) * std::numbers::pi / 4.0 / packing_fraction);
  State state{.box = Box(side, side, Edge::periodic), .seed = seed};
  Vector sum;
  for (std::uint64_t i = 0; i < n; ++i) {
    RandomStream random(seed, 0, i, Purpose::start_velocity);
    std::uint64_t const row = i / columns;
    // About half a site from row to row, and whole sites once around the box.
    double const shift = static_cast<double>(row * (rows / 2) % rows) / static_cast<double>(rows);
    Vector const v{random.normal(), random.normal()};
    sum = sum + v;
    state.agents.add((static_cast<double>(i % columns) + shift) * side / static_cast<double>(columns),
                     (static_cast<double>(row) + 0.5) * side / static_cast<double>(rows), v.x, v.y, 0.5, 1.0, 0, 0);
  }
  for (double& v : state.agents.column<VelocityX>()) v -= sum.x / static_cast<double>(n);
  for (double& v : state.agents.column<VelocityY>()) v -= sum.y / static_cast<double>(n);
  return state;
}

/// P* = βPσ² of equal disks at `packing_fraction` while the engine runs until the stop condition holds, by the virial
/// of the collisions.
inline double pressure_up_to(StopCondition const& stop_condition, Engine& engine, State& state, Counters& counters,
                             double packing_fraction) {
  double const n = static_cast<double>(state.agents.size());
  double const kt = kinetic_energy(state.agents) / (n - 1.0);
  double const virial = counters.pair_virial;
  double const time = state.clock.time;
  engine.advance(state, counters, stop_condition);
  double const z = 1.0 + (counters.pair_virial - virial) / (2.0 * n * kt * (state.clock.time - time));
  return z * 4.0 * packing_fraction / std::numbers::pi;
}

}  // namespace gridlock::validation
