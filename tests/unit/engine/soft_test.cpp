// The engine soft refuses set-ups that it cannot advance, and a run of it that fails says why.

#include "engine/soft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "core/decay.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/problem_of_engine.hpp"

namespace gridlock {
namespace {

using reference::problem_of;

State lattice(Box const& box = Box(12.0, 12.0, Edge::periodic)) {
  DisksSettings const disks{.count = 100, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square};
  State state = make_start(box, disks, 1);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  return state;
}

EngineSettings settings_of(PairPotential potential, double time_step = 0.005) {
  return {.kind = "soft", .time_step = time_step, .threads = 1, .potential = {.kind = potential}};
}

/// How a run fails, and that it leaves the state of the last call.
std::string failure_of(EngineSettings const& settings, State state, std::uint64_t steps) {
  State const before = state;
  auto const engine = make_engine(settings, state);
  Counters counters;
  try {
    engine->advance(state, counters, {.step = steps});
  } catch (RunFailure const& failure) {
    EXPECT_EQ(hash(state), hash(before));
    EXPECT_EQ(counters.moves, 0U);
    return failure.what();
  }
  return "";
}

TEST(SoftEngine, RefusesWhatItCannotMove) {
  EngineSettings const liquid = settings_of(PairPotential::lennard_jones);
  EXPECT_EQ(problem_of(liquid, lattice()), "");
  EXPECT_EQ(problem_of(liquid, lattice(Box(12.0, 12.0, Edge::wall))),
            "box.edge: the engine \"soft\" has no walls, and the box is walled");
  EngineSettings wide = liquid;
  wide.potential.cutoff = 6.5;
  EXPECT_EQ(problem_of(wide, lattice()),
            "box: in a periodic box of 12 × 12 a disk could feel two images of another; the potential "
            "\"lennard_jones\" of these disks needs sides of at least 13.13");
  EngineSettings falling = liquid;
  falling.gravity.y = -1.0;
  EXPECT_EQ(problem_of(falling, lattice()), "gravity: the engine \"soft\" has no gravity");
  EngineSettings lossy = liquid;
  lossy.collisions.restitution = 0.9;
  EXPECT_EQ(problem_of(lossy, lattice()),
            "collisions.restitution: the engine \"soft\" has no collisions that lose energy");
  EngineSettings divided = liquid;
  divided.walls = {{.from = {1.0, 1.0}, .to = {2.0, 1.0}}};
  EXPECT_EQ(problem_of(divided, lattice()), "walls: the engine \"soft\" has no walls inside the box");
  EngineSettings swimming = liquid;
  swimming.propulsion.speed = 1.0;
  EXPECT_EQ(problem_of(swimming, lattice()),
            "propulsion.speed: disks of the engine \"soft\" propel themselves against the friction of the overdamped "
            "thermostat, but thermostat.kind is \"none\"");
  for (auto const kind : {ThermostatKind::andersen, ThermostatKind::brownian}) {
    EngineSettings kicked = liquid;
    kicked.thermostat = {.kind = kind, .temperature = 1.0};
    EXPECT_EQ(problem_of(kicked, lattice()),
              "thermostat.kind: the engine \"soft\" has no thermostat \"" + std::string(to_text(kind)) + "\"");
  }
  EXPECT_EQ(problem_of({.kind = "exact", .thermostat = {.kind = ThermostatKind::langevin}}, lattice()),
            "thermostat.kind: the engine \"exact\" has no thermostat \"langevin\"");
}

TEST(SoftEngine, RefusesOverlapsOfSteepPotentialsOnly) {
  State state = lattice();
  state.agents.column<X>()[1] = state.agents.column<X>()[0] + 0.5;
  state.agents.column<Y>()[1] = state.agents.column<Y>()[0];
  EXPECT_EQ(problem_of(settings_of(PairPotential::harmonic), state), "");
  EXPECT_EQ(problem_of(settings_of(PairPotential::hertzian), state), "");
  std::string const text = problem_of(settings_of(PairPotential::wca), state);
  EXPECT_EQ(text, "disks: 1 pairs of disks are nearer than 0.8 of the sum of their radii; disks " +
                      text.substr(text.find("; disks ") + 8, 7) +
                      " are at 0.5, where the potential \"wca\" has the energy 1.61e+04");
}

TEST(SoftEngine, TakesATableAsFarAsItGoes) {
  EngineSettings settings = settings_of(PairPotential::table);
  settings.potential.distances = {0.95, 1.0, 1.1, 1.2};
  settings.potential.energies = {1.0, 0.8, 0.3, 0.0};
  EXPECT_EQ(problem_of(settings, lattice()), "");
  State near = lattice();
  near.agents.column<X>()[1] = near.agents.column<X>()[0] + 0.9;
  near.agents.column<Y>()[1] = near.agents.column<Y>()[0];
  std::string const refused = problem_of(settings, near);
  EXPECT_NE(
      refused.find("1 pairs of disks are nearer than the first distance 0.95 of the table of the potential; disks "),
      std::string::npos)
      << refused;
  // The energy of 1 is too low to keep disks apart that approach each other.
  State fast = lattice();
  for (double& v : fast.agents.column<VelocityX>()) v *= 5.0;
  std::string const failed = failure_of(settings, fast, 2000);
  EXPECT_NE(failed.find("of the sum of their radii apart, nearer than the first distance 0.95 of the table of the "
                        "potential\n  hint: use a table that begins nearer, or a shorter engine.time_step"),
            std::string::npos)
      << failed;
  settings.potential.energies.pop_back();
  EXPECT_EQ(problem_of(settings, lattice()),
            "potential.energies: the table of the potential has 4 distances and 3 energies");
  settings.kind = "exact";
  EXPECT_EQ(problem_of(settings, lattice()), "") << "hard disks have no potential";
}

TEST(SoftEngine, FailsWithAShorterStepWhereTheStepIsTooLong) {
  std::string const far = failure_of(settings_of(PairPotential::lennard_jones, 0.5), lattice(), 100);
  EXPECT_NE(far.find("diameters of the smallest disk in one time step, more than 0.5"), std::string::npos) << far;
  EXPECT_NE(far.find("hint: use a shorter engine.time_step, such as 0.0"), std::string::npos) << far;
  std::string const hot = failure_of(settings_of(PairPotential::wca, 0.042), lattice(), 3000);
  EXPECT_NE(hot.find("step 1000: the energy has changed by"), std::string::npos) << hot;
  EXPECT_EQ(failure_of(settings_of(PairPotential::lennard_jones), lattice(), 3000), "");
}

TEST(Decay, IsTheExponentialFunction) {
  EXPECT_EQ(decay(0.0), 1.0);
  for (double x = 1e-6; x < 30.0; x *= 1.7) EXPECT_NEAR(decay(x) / std::exp(-x), 1.0, 1e-13) << x;
  EXPECT_EQ(decay(1e4), 0.0);
}

}  // namespace
}  // namespace gridlock
