// Soft disks in a steady flow: exact paths of free disks, and a flow that has no place and no origin of its own.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/pair_law.hpp"
#include "engine/soft.hpp"
#include "engine/soft/system.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/lattice/start.hpp"
#include "observe/displacement.hpp"
#include "property/soft_runs.hpp"
#include "reference/unwrapped_place.hpp"

namespace gridlock {
namespace {

State flowing_fluid(std::uint64_t seed, double packing_fraction = 0.5, std::uint64_t count = 300) {
  return test::soft_disks(StartKind::random, packing_fraction, count, seed);
}

EngineSettings flow_settings(ThermostatKind thermostat, double shear_rate) {
  EngineSettings settings{.kind = "soft",
                          .time_step = 0.004,
                          .threads = 1,
                          .potential = {.kind = PairPotential::harmonic, .energy = 20.0},
                          .flow = {.shear_rate = shear_rate}};
  if (thermostat != ThermostatKind::none) {
    settings.thermostat = {.kind = thermostat, .temperature = 0.1, .friction = 200.0};
  }
  return settings;
}

constexpr std::array all_dynamics{ThermostatKind::none, ThermostatKind::langevin, ThermostatKind::overdamped};

TEST(Flow, CarriesFreeDisksOnStraightLines) {
  State const start = flowing_fluid(3, 1e-4, 20);  // they hardly meet
  for (double const rate : {2.0, -0.7}) {
    State state = start;
    EngineSettings settings = flow_settings(ThermostatKind::none, rate);
    settings.time_step = 0.1;
    SoftEngine engine(settings, state);
    Counters counters;
    engine.advance(state, counters, {.time = 2.0});
    double const time = state.clock.time;
    double const strain = rate * time;
    EXPECT_NEAR(state.box.shift(), strain * 0.9 - 1.3 * std::round(strain * 0.9 / 1.3), 1e-9);
    std::size_t free = 0;
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const r = position(start.agents, i);
      Vector const v = velocity(start.agents, i);
      Vector const expected{r.x + (v.x + rate * r.y) * time, r.y + v.y * time};
      Vector const d = reference::unwrapped_place(state, i) - expected;
      if (std::abs(d.y) > 1e-6) continue;  // one of the few that have met others
      ++free;
      EXPECT_NEAR(d.x, 0.0, 1e-9);
      EXPECT_NEAR(d.y, 0.0, 1e-9);
      EXPECT_NEAR(velocity(state.agents, i).x, v.x - rate * v.y * time, 1e-9);
    }
    EXPECT_GT(free, state.agents.size() / 2);
  }
}

TEST(Flow, IsTheSameWhereverTheOriginIs) {
  // All disks are shifted up by half the box: those that leave it come back below, where the flow is slower.
  State const start = flowing_fluid(5);
  State shifted = start;
  shifted.box = start.box.shifted(0.3);
  State state = shifted;
  for (std::size_t i = 0; i < shifted.agents.size(); ++i) {
    Vector const p = position(shifted.agents, i);
    Vector const up = shifted.box.inside({p.x, p.y + 0.5 * shifted.box.height()});
    shifted.agents.column<X>()[i] = up.x;
    shifted.agents.column<Y>()[i] = up.y;
  }
  EngineSettings const settings = flow_settings(ThermostatKind::none, 1.5);
  for (State* const each : {&state, &shifted}) {
    Counters counters;
    SoftEngine(settings, *each).advance(*each, counters, {.step = 300});
  }
  EXPECT_EQ(state.box, shifted.box);
  for (std::size_t i = 1; i < state.agents.size(); ++i) {
    Vector const one = state.box.displacement(position(state.agents, 0), position(state.agents, i));
    Vector const other = shifted.box.displacement(position(shifted.agents, 0), position(shifted.agents, i));
    // The nearest image of a disk half a box away is a matter of rounding.
    if (std::abs(one.y) > 0.449 || std::abs(one.x) > 0.649) continue;
    EXPECT_NEAR(one.x, other.x, 1e-7);
    EXPECT_NEAR(one.y, other.y, 1e-7);
  }
}

TEST(Flow, HasTheSameBitsForAnyThreadsChunksAndSkin) {
  State const start = flowing_fluid(7);
  for (ThermostatKind const kind : all_dynamics) {
    for (double const rate : {30.0, -0.5}) {
      EngineSettings settings = flow_settings(kind, rate);
      if (rate == -0.5) settings.potential = {.kind = PairPotential::wca};
      test::expect_same_bits_for_any_threads_chunks_and_skin(settings, start, 120);
    }
  }
}

TEST(ObliqueSoftDisks, HaveForcesOfAllPairsWithAnyInstructions) {
  for (double const tilt : {0.2, -0.5, 0.61}) {
    State state = flowing_fluid(9);
    state.box = state.box.tilted(tilt);
    PotentialSettings const potential{.kind = PairPotential::harmonic};
    RadiusRange const radii = radius_range(state.agents);
    soft::ForceRule const rule = soft::force_rule(potential, state.box, radii);
    ThreadPool pool(2);
    soft::Disks disks(state);
    auto const bands = soft::make_lists(state.box, soft::list_reach(potential, state.box, radii), disks, pool);
    PairLaw const law(potential);
    std::vector<Vector> expected;
    for (Target const target : available_targets()) {
      std::vector<Vector> forces;
      for (soft::Band const& band : bands) soft::forces_for(target, rule)(rule, band, disks);
      for (soft::Motion const& motion : disks.motions) forces.push_back(motion.force);
      if (expected.empty()) expected = forces;
      EXPECT_EQ(forces, expected) << to_text(target);
    }
    for (std::size_t k = 0; k < disks.size(); ++k) {
      Vector force;
      for (std::size_t n = 0; n < disks.size(); ++n) {
        if (n == k) continue;
        Vector const d = state.box.displacement(disks.places[n], disks.places[k]);
        force = force + law.push(squared_length(d), disks.identities[k].radius + disks.identities[n].radius) * d;
      }
      EXPECT_NEAR(expected[k].x, force.x, 1e-8 / radii.smallest);
      EXPECT_NEAR(expected[k].y, force.y, 1e-8 / radii.smallest);
    }
  }
}

TEST(ObliqueSoftDisks, OfNewtonKeepTheirEnergyAndMomentum) {
  State state = flowing_fluid(11);
  state.box = state.box.tilted(0.4);
  EngineSettings const settings = flow_settings(ThermostatKind::none, 0.0);
  ThreadPool pool(1);
  auto const energy = [&] {
    soft::System const system(settings, state, pool, 0.0);
    return system.kinetic_energy() + system.potential_energy();
  };
  double const before = energy();
  Vector const momentum_before = momentum(state.agents);
  Counters counters;
  SoftEngine(settings, state).advance(state, counters, {.step = 500});
  EXPECT_NEAR(energy() / before, 1.0, 1e-3);
  EXPECT_NEAR(momentum(state.agents).x, momentum_before.x, 1e-11);
  EXPECT_NEAR(momentum(state.agents).y, momentum_before.y, 1e-11);
}

TEST(Flow, LeavesDisplacementsWhereTheTiltIsFlipped) {
  State state = flowing_fluid(15);
  // As after a protocol, some disks have crossed edges before the run.
  for (std::size_t i = 0; i < state.agents.size(); i += 3) state.agents.column<ImageY>()[i] = -2;
  EngineSettings const settings = flow_settings(ThermostatKind::overdamped, 1.0);
  SoftEngine engine(settings, state);
  Counters counters;
  Displacement displacement;
  std::vector<double> row(3);
  displacement.begin(Snapshot(state, counters));
  std::vector<Vector> start;
  for (std::size_t i = 0; i < state.agents.size(); ++i) start.push_back(reference::unwrapped_place(state, i));
  int flips = 0;
  for (int k = 0; k < 30; ++k) {
    double const tilt = state.box.tilt();
    engine.advance(state, counters, {.time = state.clock.time + 0.1});
    flips += state.box.tilt() < tilt ? 1 : 0;
    displacement.sample(Snapshot(state, counters), row, false);
    double squares = 0.0;
    for (std::size_t i = 0; i < start.size(); ++i)
      squares += squared_length(reference::unwrapped_place(state, i) - start[i]);
    EXPECT_NEAR(row[1], squares / static_cast<double>(start.size()), 1e-9);
  }
  EXPECT_GE(flips, 2);
}

TEST(Flow, IsRefusedWhereItCannotBe) {
  State const state = flowing_fluid(13);
  auto const problem = [&](EngineSettings const& settings, State const& of) {
    try {
      make_engine(settings, of);
    } catch (Error const& error) {
      return error.problems().front().key + ": " + error.problems().front().what;
    }
    return std::string();
  };
  EngineSettings const sheared = flow_settings(ThermostatKind::overdamped, 1.0);
  EXPECT_EQ(problem(sheared, state), "");
  EngineSettings hard = sheared;
  hard.kind = "exact";
  hard.thermostat = {};
  EXPECT_EQ(problem(hard, state), "flow.shear_rate: the engine \"exact\" has no flow");
  EngineSettings swimming = sheared;
  swimming.propulsion.speed = 1.0;
  EXPECT_EQ(problem(swimming, state),
            "propulsion.speed: disks propel themselves, and the flow would turn their headings, which the engine "
            "\"soft\" does not know");
  EngineSettings fast = sheared;
  fast.flow.shear_rate = 1e5;
  EXPECT_NE(problem(fast, state).find("flow.shear_rate: the flow carries disks as far as"), std::string::npos);
  State fixed = state;
  fixed.agents.column<Mass>()[0] = std::numeric_limits<double>::infinity();
  fixed.agents.column<VelocityX>()[0] = fixed.agents.column<VelocityY>()[0] = 0.0;
  EXPECT_EQ(problem(sheared, fixed), "flow.shear_rate: 1 disks are fixed, and the flow would carry them along");
}

}  // namespace
}  // namespace gridlock
