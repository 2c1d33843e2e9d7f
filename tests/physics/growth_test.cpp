// Growth in the exact engine against numbers with a source.

#include "gridlock/engine/growth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/temperature.hpp"
#include "gridlock/engine/engine.hpp"
#include "reference/fluid_of_two_sizes.hpp"

namespace gridlock {
namespace {

using reference::fluid_of_two_sizes;

/// Z = 1 + Σ σ|Δp| / (2 N kT t) at constant size, after a while.
double compressibility(State& state, std::uint64_t equilibration, std::uint64_t collisions_a_disk) {
  Counters counters;
  auto const engine = make_engine({.kind = "exact"}, state);
  auto const count = static_cast<std::uint64_t>(state.agents.size());
  engine->advance(state, counters, {.pair_collisions = equilibration * count});
  Counters const before = counters;
  double const begin = state.clock.time;
  engine->advance(state, counters, {.pair_collisions = (equilibration + collisions_a_disk) * count});
  double const thermal = 2.0 * static_cast<double>(count) * *temperature(state) * (state.clock.time - begin);
  return 1.0 + (counters.pair_virial - before.pair_virial) / thermal;
}

/// How many disks are held by three others or more, nearer than 10⁻⁵ diameters, of which each is held as well.
std::size_t disks_of_backbone(State const& state) {
  auto const radius = state.agents.column<Radius>();
  std::size_t const count = state.agents.size();
  std::vector<std::vector<std::size_t>> neighbours(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      Vector const d = state.box.displacement(position(state.agents, i), position(state.agents, j));
      if (std::sqrt(squared_length(d)) > (1.0 + 1e-5) * (radius[i] + radius[j])) continue;
      neighbours[i].push_back(j);
      neighbours[j].push_back(i);
    }
  }
  std::vector<bool> is_held(count, true);
  auto held = static_cast<std::size_t>(count);
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (std::size_t i = 0; i < count; ++i) {
      auto const is_neighbour_held = [&](std::size_t j) { return is_held[j]; };
      if (!is_held[i] || std::ranges::count_if(neighbours[i], is_neighbour_held) >= 3) continue;
      is_held[i] = false;
      has_changed = true;
      --held;
    }
  }
  return held;
}

// An independent program, N = 256, half of them 1.4 times as large, γ = 2e-3: 4540 collisions a disk up to p = 1e5, and
// a mean density at jamming of 0.84686 with a standard deviation of 0.0009 from start to start.
TEST(GrowthPhysics, JamsWhereAnIndependentProgramDoes) {
  constexpr int starts = 4;
  double density = 0.0;
  double collisions = 0.0;
  for (std::uint64_t seed = 1; seed <= starts; ++seed) {
    State state = fluid_of_two_sizes(256, 1.4, seed);
    Counters counters;
    Growth growth({.rate = 2e-3, .pressure = 1e5, .audit_every = 100'003}, state);
    ASSERT_TRUE(growth.advance(state, counters));
    EXPECT_LT(*growth.reduced_pressure(), 1.2e5);
    density += covered_area(state.agents) / starts;
    collisions += static_cast<double>(counters.pair_collisions) / (256.0 * starts);
  }
  EXPECT_NEAR(density, 0.84686, 4.0 * 0.0009 / std::sqrt(starts));
  EXPECT_NEAR(collisions, 4540.0, 0.04 * 4540.0);
}

// At jamming p ∝ 1/(φ_J − φ): a hundred times the pressure, a hundredth of what is missing.
TEST(GrowthPhysics, ClosesTheGapsInProportionToOneOverThePressure) {
  State state = fluid_of_two_sizes(256, 1.4, 5);
  Counters counters;
  std::vector<double> densities;
  std::vector<double> pressures;
  for (double const pressure : {1e3, 1e5, 1e10}) {
    Growth growth({.rate = 2e-3, .pressure = pressure}, state);
    ASSERT_TRUE(growth.advance(state, counters));
    densities.push_back(covered_area(state.agents));
    pressures.push_back(*growth.reduced_pressure());
  }
  double const at_first = pressures[0] * (1.0 - densities[0] / densities[2]);
  double const at_second = pressures[1] * (1.0 - densities[1] / densities[2]);
  // 2 in equilibrium; while growing up to a quarter more.
  EXPECT_NEAR(at_first, 2.0, 0.5);
  EXPECT_NEAR(at_second, 2.0, 0.5);
}

// Without growth each of N₀ disks of the backbone, but for the motion of all, flies in a free volume that vanishes at
// φ_J: p (1 − φ/φ_J) = 2 (N₀ − 1)/N.
TEST(GrowthPhysics, HasThePressureOfFreeVolumeInEquilibrium) {
  State state = fluid_of_two_sizes(256, 1.4, 7);
  Counters counters;
  ASSERT_TRUE(Growth({.rate = 2e-3, .pressure = 1e4}, state).advance(state, counters));
  double const pressure = compressibility(state, 400, 2000);
  double const density = covered_area(state.agents);
  State jammed = state;
  ASSERT_TRUE(Growth({.rate = 2e-3, .pressure = 1e10}, jammed).advance(jammed, counters));
  auto const held = static_cast<double>(disks_of_backbone(jammed));
  EXPECT_GT(held, 0.9 * 256.0);
  EXPECT_NEAR(pressure * (1.0 - density / covered_area(jammed.agents)) * 256.0 / (2.0 * (held - 1.0)), 1.0, 0.04);
}

// Kolafa & Rottner 2006, Mol. Phys. 104, 3435.
TEST(GrowthPhysics, GrowsAFluidToTheKnownEquationOfState) {
  State state = fluid_of_two_sizes(900, 1.0, 1);
  Counters counters;
  ASSERT_TRUE(Growth({.rate = 5e-3, .packing_fraction = 0.65}, state).advance(state, counters));
  // Standard error of a run as long as this: 0.02.
  EXPECT_NEAR(compressibility(state, 100, 4000), 8.408, 0.06);
}

// A slow growth is a row of equilibria: the pressure measured while growing is that of the fluid.
TEST(GrowthPhysics, MeasuresThePressureOfTheFluidWhileGrowingSlowly) {
  State state = fluid_of_two_sizes(900, 1.0, 2);
  Counters counters;
  Growth growth({.rate = 1e-3, .packing_fraction = 0.6, .collisions_per_rescaling = 50.0}, state);
  ASSERT_TRUE(growth.advance(state, counters));
  EXPECT_NEAR(*growth.reduced_pressure(), 6.455, 0.05 * 6.455);
}

}  // namespace
}  // namespace gridlock
