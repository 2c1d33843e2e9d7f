// Soft disks: forces, and bits that depend on nothing but the input.

#include "engine/soft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/pair_law.hpp"
#include "engine/soft/system.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/lattice/start.hpp"
#include "property/soft_runs.hpp"
#include "reference/soft_table.hpp"

namespace gridlock {
namespace {

std::vector<PotentialSettings> potentials() {
  return {{.kind = PairPotential::harmonic, .energy = 2.0},
          {.kind = PairPotential::hertzian},
          {.kind = PairPotential::wca, .energy = 0.7},
          {.kind = PairPotential::inverse_power, .exponent = 9, .cutoff = 1.8},
          {.kind = PairPotential::inverse_power, .exponent = 12},
          {.kind = PairPotential::lennard_jones, .cutoff = 2.2},
          reference::table_of({.kind = PairPotential::wca}, 0.7, 60, 2.0),
          reference::table_of({.kind = PairPotential::lennard_jones, .energy = 1.5}, 0.7, 80, 3.0)};
}

State fluid(bool is_mixture, std::uint64_t seed, std::uint64_t count = 300) {
  return test::soft_disks(StartKind::random, 0.5, count, seed, is_mixture);
}

EngineSettings settings_of(PotentialSettings const& potential, ThermostatKind thermostat = ThermostatKind::none) {
  EngineSettings settings{.kind = "soft", .time_step = 0.004, .threads = 1, .potential = potential};
  if (thermostat != ThermostatKind::none) {
    settings.thermostat = {.kind = thermostat, .temperature = 0.1, .friction = 200.0};
  }
  return settings;
}

std::vector<EngineSettings> dynamics_of(PotentialSettings const& potential) {
  std::vector<EngineSettings> dynamics;
  for (auto const kind : {ThermostatKind::none, ThermostatKind::langevin, ThermostatKind::overdamped}) {
    dynamics.push_back(settings_of(potential, kind));
  }
  dynamics.push_back(dynamics.back());
  dynamics.back().propulsion = {.speed = 3.0, .rotational_diffusion = 2.0};
  return dynamics;
}

TEST(SoftForces, AreThoseOfAllPairs) {
  ThreadPool pool(2);
  for (bool const is_mixture : {false, true}) {
    State const state = fluid(is_mixture, 3);
    for (PotentialSettings const& potential : potentials()) {
      soft::System const system(settings_of(potential), state, pool, 0.0);
      PairLaw const law(potential);
      auto const radius = state.agents.column<Radius>();
      for (std::size_t k = 0; k < state.agents.size(); ++k) {
        std::size_t const i = system.disks().identities[k].row_in_state;
        Vector force;
        for (std::size_t j = 0; j < state.agents.size(); ++j) {
          if (i == j) continue;
          Vector const d = state.box.displacement(position(state.agents, j), position(state.agents, i));
          force = force + law.push(squared_length(d), radius[i] + radius[j]) * d;
        }
        double const unit = potential.energy / (2.0 * radius[0]);
        EXPECT_NEAR(system.disks().motions[k].force.x, force.x, 1e-8 * unit) << to_text(potential.kind);
        EXPECT_NEAR(system.disks().motions[k].force.y, force.y, 1e-8 * unit) << to_text(potential.kind);
      }
    }
  }
}

TEST(SoftForces, AreTheSlopeOfTheEnergy) {
  for (PotentialSettings const& potential : potentials()) {
    PairLaw const law(potential);
    double const sigma = 0.3;
    for (double r = 0.85 * sigma; r < 0.999 * law.cutoff() * sigma; r += 0.013 * sigma) {
      double const h = 1e-6 * sigma;
      double const slope = (law.energy((r + h) * (r + h), sigma) - law.energy((r - h) * (r - h), sigma)) / (2.0 * h);
      EXPECT_NEAR(law.push(r * r, sigma) * r, -slope, 1e-6 * (std::abs(slope) + 1.0 / sigma))
          << to_text(potential.kind);
    }
    double const limit = law.cutoff() * sigma;
    EXPECT_NEAR(law.energy(0.999999 * limit * limit, sigma), 0.0, 1e-4);
    EXPECT_EQ(law.energy(limit * limit, sigma), 0.0);
    EXPECT_EQ(law.push(limit * limit, sigma), 0.0);
  }
}

TEST(SoftForces, AreTheSameBitsWithAnyInstructions) {
  for (bool const is_mixture : {false, true}) {
    State const state = fluid(is_mixture, 5);
    for (PotentialSettings const& potential : potentials()) {
      RadiusRange const radii = radius_range(state.agents);
      soft::ForceRule const rule = soft::force_rule(potential, state.box, radii);
      ThreadPool pool(1);
      soft::Disks disks(state);
      auto const bands = soft::make_lists(state.box, soft::list_reach(potential, state.box, radii), disks, pool);
      std::vector<Vector> expected;
      for (Target const target : available_targets()) {
        std::vector<Vector> forces;
        for (soft::Band const& band : bands) soft::forces_for(target, rule)(rule, band, disks);
        for (soft::Motion const& motion : disks.motions) forces.push_back(motion.force);
        if (expected.empty()) expected = forces;
        EXPECT_EQ(forces, expected) << to_text(potential.kind) << " " << to_text(target);
      }
    }
  }
}

TEST(SoftDisks, HaveTheSameBitsForAnyThreadsChunksAndSkin) {
  for (bool const is_mixture : {false, true}) {
    State const start = fluid(is_mixture, 7);
    for (PotentialSettings const& potential : potentials()) {
      for (EngineSettings const& settings : dynamics_of(potential)) {
        test::expect_same_bits_for_any_threads_chunks_and_skin(settings, start, 40);
      }
    }
  }
}

TEST(SoftDisks, OfNewtonGoBackWhereTheyCameFrom) {
  for (PotentialSettings const& potential : potentials()) {
    State const start = fluid(true, 9);
    State state = start;
    SoftEngine engine(settings_of(potential), state);
    Counters counters;
    engine.advance(state, counters, {.step = 100});
    for (auto& v : state.agents.column<VelocityX>()) v = -v;
    for (auto& v : state.agents.column<VelocityY>()) v = -v;
    double const moved = state.box.displacement(position(start.agents, 0), position(state.agents, 0)).x;
    EXPECT_GT(std::abs(moved), 1e-6);
    engine.advance(state, counters, {.step = 200});
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const d = state.box.displacement(position(start.agents, i), position(state.agents, i));
      EXPECT_LT(std::sqrt(squared_length(d)), 1e-7) << to_text(potential.kind);
    }
  }
}

TEST(SoftDisks, OfNewtonKeepTheirMomentum) {
  for (PotentialSettings const& potential : potentials()) {
    State state = fluid(true, 11);
    Vector const before = momentum(state.agents);
    SoftEngine engine(settings_of(potential), state);
    Counters counters;
    engine.advance(state, counters, {.step = 300});
    EXPECT_NEAR(momentum(state.agents).x, before.x, 1e-11);
    EXPECT_NEAR(momentum(state.agents).y, before.y, 1e-11);
  }
}

TEST(SoftDisks, ThatAreFixedStay) {
  State start = fluid(false, 13);
  for (std::size_t i = 0; i < start.agents.size(); i += 3) {
    start.agents.column<Mass>()[i] = std::numeric_limits<double>::infinity();
    start.agents.column<VelocityX>()[i] = 0.0;
    start.agents.column<VelocityY>()[i] = 0.0;
  }
  for (auto const kind : {ThermostatKind::none, ThermostatKind::langevin, ThermostatKind::overdamped}) {
    State state = start;
    SoftEngine engine(settings_of({.kind = PairPotential::wca}, kind), state);
    Counters counters;
    engine.advance(state, counters, {.step = 50});
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      EXPECT_EQ(position(state.agents, i) == position(start.agents, i), i % 3 == 0);
    }
  }
}

}  // namespace
}  // namespace gridlock
