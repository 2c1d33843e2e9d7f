#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::reference {

/// Disks of mass 1 and mean temperature 1, every other one `ratio` times as large, from a square lattice with sizes at
/// random places to a fluid at packing fraction 0.40, after a hundred collisions a disk.
inline State fluid_of_two_sizes(std::uint64_t count, double ratio, std::uint64_t seed) {
  State state{.box = Box(1.0, 1.0, Edge::periodic), .seed = seed};
  auto const columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  double const step = 1.0 / static_cast<double>(columns);
  double const mean_square = 0.5 * (1.0 + ratio * ratio);
  double const radius = std::sqrt(0.4 / (static_cast<double>(count) * std::numbers::pi * mean_square));
  std::vector<double> radii;
  for (std::uint64_t i = 0; i < count; ++i) radii.push_back(i % 2 == 0 ? radius : ratio * radius);
  RandomStream random(seed, 0, 0, Purpose::start_position);
  for (std::uint64_t i = count; i > 1; --i) std::swap(radii[i - 1], radii[random.below(i)]);
  for (std::uint64_t i = 0; i < count; ++i) {
    RandomStream velocity(seed, 0, i, Purpose::start_velocity);
    double const x = velocity.normal();
    double const y = velocity.normal();
    state.agents.add((static_cast<double>(i % columns) + 0.5) * step, (static_cast<double>(i / columns) + 0.5) * step,
                     x, y, radii[i], 1.0, 0, 0);
  }
  Counters counters;
  make_engine({.kind = "exact"}, state)->advance(state, counters, {.pair_collisions = 100 * count});
  return state;
}

}  // namespace gridlock::reference
