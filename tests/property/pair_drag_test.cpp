// A drag between soft disks that touch: what it keeps, what it takes, and bits that depend on nothing but the input.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/soft.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/lattice/start.hpp"
#include "observe/stress.hpp"
#include "property/soft_runs.hpp"
#include "reference/problem_of_engine.hpp"

namespace gridlock {
namespace {

using reference::problem_of;

State grains(std::uint64_t seed, double packing_fraction = 0.9, std::uint64_t count = 120) {
  return test::soft_disks(StartKind::uniform, packing_fraction, count, seed);
}

/// Settings with a drag of a tenth of the mass of the lighter disks in the time of the potential.
EngineSettings grain_settings(DragDirection direction, double shear_rate = 0.0) {
  return {.kind = "soft",
          .time_step = 0.02,
          .speed = 3.0,
          .threads = 1,
          .potential = {.kind = PairPotential::harmonic, .energy = 9.0},
          .flow = {.shear_rate = shear_rate},
          .pair_drag = {.coefficient = 20.0, .direction = direction}};
}

constexpr std::array directions{DragDirection::all, DragDirection::normal};

TEST(PairDrag, HasTheSameBitsForAnyThreadsChunksAndSkin) {
  State const start = grains(3);
  for (DragDirection const direction : directions) {
    for (double const rate : {0.0, 12.0}) {
      EngineSettings settings = grain_settings(direction, rate);
      test::expect_same_bits_for_any_threads_chunks_and_skin(settings, start, 60);
      settings.thermostat = {.kind = ThermostatKind::langevin, .temperature = 0.0, .friction = 2.0};
      test::expect_same_bits_for_any_threads_chunks_and_skin(settings, start, 60);
    }
  }
}

TEST(PairDrag, KeepsTheMomentumAndCoolsTheDisks) {
  for (DragDirection const direction : directions) {
    State state = grains(5);
    Vector const before = momentum(state.agents);
    double const energy = kinetic_energy(state.agents);
    SoftEngine engine(grain_settings(direction), state);
    Counters counters;
    engine.advance(state, counters, {.step = 4000});
    EXPECT_NEAR(momentum(state.agents).x, before.x, 1e-12);
    EXPECT_NEAR(momentum(state.agents).y, before.y, 1e-12);
    // The motion of the centre and slow modes outlast the others.
    EXPECT_LT(kinetic_energy(state.agents), 0.05 * energy);
  }
}

/// Energy, dissipation and shear stress of all pairs, one by one.
struct Balance {
  double energy = 0.0;
  double lost = 0.0;    ///< per time, to the drag
  double gained = 0.0;  ///< per time, from the flow: γ̇ A σ_xy
};

Balance balance_of(State const& state, EngineSettings const& settings) {
  Disks const& disks = state.agents;
  auto const radius = disks.column<Radius>();
  double const rate = settings.flow.shear_rate;
  Balance balance{.energy = kinetic_energy(disks)};
  for (std::size_t i = 0; i < disks.size(); ++i) {
    Vector const v = velocity(disks, i);
    balance.gained -= rate * disks.column<Mass>()[i] * v.x * v.y;
    for (std::size_t j = 0; j < i; ++j) {
      Vector const r = state.box.displacement(position(disks, j), position(disks, i));
      double const distance = std::sqrt(squared_length(r));
      double const sigma = radius[i] + radius[j];
      if (distance >= sigma) continue;
      double const overlap = 1.0 - distance / sigma;
      balance.energy += 0.5 * settings.potential.energy * overlap * overlap;
      Vector const n = (1.0 / distance) * r;
      Vector const w = v - velocity(disks, j) + Vector{rate * r.y, 0.0};
      Vector const slowed = settings.pair_drag.direction == DragDirection::all ? w : dot(w, n) * n;
      Vector const drag = -settings.pair_drag.coefficient * slowed;
      balance.lost -= dot(drag, w);
      balance.gained -= rate * (settings.potential.energy * overlap / sigma * n.x + drag.x) * r.y;
    }
  }
  return balance;
}

double shear_stress(State const& state, EngineSettings const& settings) {
  Stress stress({.potential = settings.potential, .pair_drag = settings.pair_drag, .flow = settings.flow});
  std::vector<double> row(6);
  Counters const counters;
  stress.begin(Snapshot(state, counters));
  stress.sample(Snapshot(state, counters), row, false);
  return row[3];
}

TEST(PairDrag, LosesTheEnergyThatTheFlowGives) {
  for (DragDirection const direction : directions) {
    for (double const rate : {0.0, 4.0}) {
      EngineSettings settings = grain_settings(direction, rate);
      settings.time_step = 0.004;
      State state = grains(7);
      SoftEngine engine(settings, state);
      Counters counters;
      engine.advance(state, counters, {.step = 1000});
      double const start = balance_of(state, settings).energy;
      double expected = start;
      double lost = 0.0;
      constexpr int steps = 400;
      for (int k = 0; k <= steps; ++k) {
        Balance const now = balance_of(state, settings);
        double const weight = (k == 0 || k == steps ? 0.5 : 1.0) * engine.time_step();
        expected += weight * (now.gained - now.lost);
        lost += weight * now.lost;
        EXPECT_NEAR(rate * state.box.area() * shear_stress(state, settings), now.gained, 1e-9 * (1.0 + now.lost));
        if (k < steps) engine.advance(state, counters, {.step = state.clock.step + 1});
      }
      EXPECT_GT(lost, 0.002 * start);
      EXPECT_NEAR(balance_of(state, settings).energy, expected, 0.002 * lost) << rate;
    }
  }
}

TEST(PairDrag, OfAFixedDiskStopsTheCommonMotionOfTheOthers) {
  State state = grains(9, 0.9, 30);
  for (double& v : state.agents.column<VelocityX>()) v += 1.0;
  state.agents.column<Mass>()[4] = std::numeric_limits<double>::infinity();
  state.agents.column<VelocityX>()[4] = state.agents.column<VelocityY>()[4] = 0.0;
  Vector const place = position(state.agents, 4);
  double const energy = kinetic_energy(state.agents);
  SoftEngine engine(grain_settings(DragDirection::all), state);
  Counters counters;
  engine.advance(state, counters, {.step = 8000});
  EXPECT_EQ(position(state.agents, 4), place);
  EXPECT_LT(kinetic_energy(state.agents), 1e-3 * energy);
}

TEST(PairDrag, ThatIsTooLargeToBeAddedUpEndsTheRun) {
  State state{.box = Box(10.0, 10.0, Edge::periodic)};
  for (double const side : {-1.0, 1.0}) state.agents.add(5.0 + 0.49 * side, 5.0, -100.0 * side, 0.0, 0.5, 1.0, 0, 0);
  SoftEngine engine({.kind = "soft", .time_step = 0.002, .speed = 1.0, .pair_drag = {.coefficient = 90.0}}, state);
  std::uint64_t const before = hash(state);
  Counters counters;
  try {
    engine.advance(state, counters, {.step = 10});
    ADD_FAILURE();
  } catch (RunFailure const& failure) {
    EXPECT_EQ(
        std::string(failure.what()),
        "step 0: the drag between two disks that touch is 1.8e+04, more than 4.1e+03, the largest that can be added "
        "up\n  hint: use a lower pair_drag.coefficient, or a higher potential.energy");
  }
  EXPECT_EQ(hash(state), before);
}

TEST(PairDrag, IsRefusedWhereItMakesNoSense) {
  State const state = grains(11);
  EngineSettings const settings = grain_settings(DragDirection::all);
  EXPECT_EQ(problem_of(settings, state), "");
  EngineSettings without_inertia = settings;
  without_inertia.thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.0, .friction = 1.0};
  EXPECT_EQ(
      problem_of(without_inertia, state),
      "pair_drag.coefficient: disks without inertia have no velocities that a drag of pairs could slow down: they "
      "would follow from a system of equations in each step");
  EngineSettings warm = settings;
  warm.thermostat = {.kind = ThermostatKind::langevin, .temperature = 1.0, .friction = 1.0};
  std::string const colder =
      "pair_drag.coefficient: a drag of pairs takes energy that the noise of the thermostat \"langevin\" does not give "
      "back, so the disks would be colder than thermostat.temperature";
  EXPECT_EQ(problem_of(warm, state), colder);
  warm.thermostat.temperature = {};
  EXPECT_EQ(problem_of(warm, state), colder);
  EngineSettings hard = settings;
  hard.kind = "exact";
  hard.flow = {};
  EXPECT_EQ(problem_of(hard, state), "pair_drag.coefficient: the engine \"exact\" has no drag of pairs");
  EngineSettings strong = settings;
  strong.pair_drag.coefficient = 1e4;
  EXPECT_NE(problem_of(strong, state).find("in one time step the drag of one neighbour would change the velocity"),
            std::string::npos);
}

}  // namespace
}  // namespace gridlock
