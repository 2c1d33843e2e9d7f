#include "gridlock/engine/grains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/simulation/run.hpp"
#include "gridlock/simulation/setup.hpp"
#include "reference/hard_engines.hpp"
#include "reference/problem_of_engine.hpp"

namespace gridlock {
namespace {

using reference::problem_of;

State two_disks() {
  State state{.box = Box(3.0, 2.0, Edge::wall), .seed = 9};
  state.agents.add(1.0, 1.0, 1.0, 0.0, 0.25, 1.0, 0, 0);
  state.agents.add(2.0, 1.0, -1.0, 0.0, 0.25, 1.0, 0, 0);
  return state;
}

TEST(Walls, AreRefusedOutsideTheBoxAndAcrossDisks) {
  for (std::string const& kind : reference::hard_engine_kinds()) {
    auto const problem = [&](WallSettings const& wall) {
      return problem_of({.kind = kind, .walls = {{.from = {0.0, 0.0}, .to = {0.5, 0.0}}, wall}}, two_disks());
    };
    EXPECT_EQ(problem({.from = {0.1, 0.2}, .to = {0.1}}), "walls[1]: wall 2 has 2 and 1 numbers for its two points");
    EXPECT_EQ(problem({.from = {0.1, 0.2}, .to = {0.1, 2.5}}),
              "walls[1]: wall 2 has a point (0.1, 2.5) outside the box of 3 × 2");
    EXPECT_EQ(problem({.from = {0.1, 0.2}, .to = {0.1, 0.2}}), "walls[1]: wall 2 is the point (0.1, 0.2)");
    EXPECT_EQ(problem({.from = {1.2, 0.0}, .to = {1.2, 2.0}}),
              "walls: disk 0 at (1, 1) of radius 0.25 overlaps the wall from (1.2, 0) to (1.2, 2) by 0.05");
    EXPECT_EQ(problem({.from = {1.25, 0.0}, .to = {1.25, 2.0}}), "");
  }
}

TEST(Grains, AreRefusedByEnginesWithATimeStep) {
  for (char const* kind : {"stepped", "tiled"}) {
    std::string const engine = std::string("the engine \"") + kind + "\" has no ";
    EXPECT_EQ(problem_of({.kind = kind, .gravity = {.y = -1.0}}, two_disks()), "gravity: " + engine + "gravity");
    EXPECT_EQ(problem_of({.kind = kind, .collisions = {.wall_restitution = 0.5}}, two_disks()),
              "collisions.restitution: " + engine + "collisions that lose energy");
  }
}

TEST(FixedDisks, StopOthersInEveryEngineAndStay) {
  for (std::string const& kind : reference::hard_engine_kinds()) {
    State state = two_disks();
    state.agents.column<Mass>()[1] = std::numeric_limits<double>::infinity();
    state.agents.column<VelocityX>()[1] = 0.0;
    Counters counters;
    make_engine({.kind = kind}, state)->advance(state, counters, {.time = 0.9});
    EXPECT_EQ(counters.pair_collisions, 1U) << kind;
    EXPECT_EQ(velocity(state.agents, 0), (Vector{-1.0, 0.0})) << kind;
    EXPECT_EQ(position(state.agents, 1), (Vector{2.0, 1.0})) << kind;
    EXPECT_EQ(kinetic_energy(state.agents), 0.5) << kind;
  }
}

TEST(FixedDisks, CountInNoMeanOfMotion) {
  Configuration configuration;
  configuration.disks = {
      .count = 100, .packing_fraction = 0.2, .species = {{.fraction = 0.5, .fixed = true}, {.fraction = 0.5}}};
  configuration.velocities.max = 1.0;
  configuration.engine.kind = "exact";
  configuration.run.steps = 100;
  gridlock::Setup const setup = set_up(configuration);
  gridlock::Run run(*setup.simulation, plan_of(setup));
  run.advance();
  double energy = 0.0;
  double moment_ratio = 0.0;
  for (auto const& [name, estimate, unit] : run.record().results) {
    if (name == "kinetic_energy") energy = estimate.value;
    if (name == "speed_moment_ratio") moment_ratio = estimate.value;
    if (name == "mean_speed") {
      EXPECT_NEAR(estimate.value, std::sqrt(std::numbers::pi / 2.0 * energy / 50.0), 0.15 * estimate.value);
    }
  }
  EXPECT_GT(energy, 0.0);
  EXPECT_NEAR(moment_ratio, 2.0, 0.4);
}

Configuration falling(Edge edge) {
  Configuration configuration;
  configuration.box = {.edge = edge, .width = 3.0, .height = 2.0};
  configuration.disks = {.count = 20, .packing_fraction = 0.2};
  configuration.engine.kind = "exact";
  configuration.engine.gravity.y = -1.0;
  return configuration;
}

TEST(Gravity, AlongPeriodicEdgesNeedsSomethingThatHoldsTheDisks) {
  EXPECT_NO_THROW(set_up(falling(Edge::wall)));
  try {
    set_up(falling(Edge::periodic));
    FAIL();
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().front().key, "gravity.y");
  }
  Configuration losing = falling(Edge::periodic);
  losing.engine.collisions.restitution = 0.8;
  EXPECT_THROW(set_up(losing), Error) << "collisions of disks keep their common motion";
  losing.disks.species = {{.fraction = 0.2, .fixed = true}, {.fraction = 0.8}};
  EXPECT_NO_THROW(set_up(losing));
  Configuration kicked = falling(Edge::periodic);
  kicked.engine.thermostat.kind = ThermostatKind::brownian;
  EXPECT_NO_THROW(set_up(kicked));
}

TEST(Restitution, ThatMayCollapseIsNotedUnlessContactsLast) {
  auto const has_note = [](double restitution, double contact_time) {
    Configuration configuration = falling(Edge::wall);
    configuration.engine.collisions = {.restitution = restitution, .contact_time = contact_time};
    for (Event const& note : set_up(configuration).notes) {
      if (note.kind == EventKind::losing_energy) return true;
    }
    return false;
  };
  EXPECT_TRUE(has_note(0.8, 0.0));
  EXPECT_FALSE(has_note(0.8, 1e-4));
  EXPECT_FALSE(has_note(0.99, 0.0));
}

TEST(ContactTime, ThatIsLongIsNotedWithTheShareOfElasticCollisions) {
  auto const percent = [](double contact_time) {
    Configuration configuration = falling(Edge::periodic);
    configuration.engine.gravity = {};
    configuration.engine.collisions = {.restitution = 0.8, .contact_time = contact_time};
    configuration.engine.thermostat = {.kind = ThermostatKind::andersen, .temperature = 1.0};
    for (Event const& note : set_up(configuration).notes) {
      if (note.kind == EventKind::lasting_contacts) return std::get<double>(note.values[0].second);
    }
    return 0.0;
  };
  // Γ = 2 σ ρ g √(π kT/m), with σ from φ = 0.2 of 20 disks in a box of area 6, and g(0.2) = 0.9125/0.64.
  double const diameter = std::sqrt(4.0 * 0.2 * 6.0 / (20.0 * std::numbers::pi));
  double const rate = 2.0 * diameter * (20.0 / 6.0) * (0.9125 / 0.64) * std::sqrt(std::numbers::pi);
  EXPECT_NEAR(percent(0.1), 100.0 * (1.0 - std::exp(-0.2 * rate)), 1e-9);
  EXPECT_EQ(percent(1e-4), 0.0);
}

TEST(Gravity, ThatMakesFallsTooShortToCountIsRefused) {
  Configuration configuration = falling(Edge::wall);
  configuration.engine.gravity.y = -1e60;
  EXPECT_THROW(set_up(configuration), Error);
}

TEST(Propulsion, WithTurnsTooLargeToTellIsRefused) {
  for (char const* const kind : {"stepped", "tiled", "exact"}) {
    Configuration swimmers;
    swimmers.disks = {.count = 20, .packing_fraction = 0.2};
    swimmers.engine.kind = kind;
    if (swimmers.engine.kind == "exact") swimmers.engine.thermostat.kind = ThermostatKind::brownian;
    swimmers.engine.propulsion = {.speed = 1.0, .rotational_diffusion = 1e20};
    EXPECT_THROW(set_up(swimmers), Error) << kind;
    swimmers.engine.propulsion.rotational_diffusion = 1e3;
    EXPECT_NO_THROW(set_up(swimmers)) << kind;
  }
}

TEST(Region, HoldsTheWholeStartWhateverItsKind) {
  for (StartKind const start : {StartKind::square, StartKind::triangular, StartKind::random}) {
    DisksSettings const disks{.count = 50, .packing_fraction = 0.4, .start = start, .region = {1.0, 0.5, 2.5, 1.5}};
    State const state = make_start(Box(3.0, 2.0, Edge::periodic), disks, 1);
    EXPECT_EQ(state.box, Box(3.0, 2.0, Edge::periodic));
    EXPECT_NEAR(covered_area(state.agents), 0.4 * 1.5, 1e-12);
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      Vector const p = position(state.agents, i);
      double const r = state.agents.column<Radius>()[i] * (1.0 - 1e-12);
      EXPECT_TRUE(p.x >= 1.0 + r && p.x <= 2.5 - r && p.y >= 0.5 + r && p.y <= 1.5 - r) << p.x << ", " << p.y;
    }
  }
  EXPECT_THROW(make_start(Box(3.0, 2.0, Edge::wall), {.count = 5, .radius = 0.1, .region = {1.0, 0.5, 2.5, 2.5}}, 1),
               Error);
}

}  // namespace
}  // namespace gridlock
