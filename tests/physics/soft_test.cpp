// Soft disks against exact values and numbers of an independent program.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "core/pair_law.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/simulation/simulate.hpp"
#include "observe/stress.hpp"
#include "reference/mean_and_error.hpp"
#include "reference/soft_table.hpp"
#include "reference/unwrapped_place.hpp"

namespace gridlock {
namespace {

/// 256 disks of diameter 1 and mass 1 at a density, with velocities of the temperature.
State fluid(double density, double temperature, std::uint64_t count = 256) {
  double const side = std::sqrt(static_cast<double>(count) / density);
  State state = make_start(Box(side, side, Edge::periodic),
                           {.count = count, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square}, 5);
  draw_velocities(state, {.kind = VelocityKind::maxwell});
  double const now = kinetic_energy(state.agents) / static_cast<double>(count);
  double const factor = std::sqrt(temperature / now);
  for (auto& v : state.agents.column<VelocityX>()) v *= factor;
  for (auto& v : state.agents.column<VelocityY>()) v *= factor;
  return state;
}

struct Fluid {
  PotentialSettings potential;
  double density;
  double temperature;
  double time_step;
  double pressure;  ///< with the temperature of the bath
  double pressure_tolerance;
  double energy;  ///< U/N
  double energy_tolerance;
};

/// Computed once by an independent program: velocity Verlet, BAOAB, N = 256.
std::vector<Fluid> fluids() {
  return {{{.kind = PairPotential::harmonic}, 1.0, 0.01, 0.05, 0.05637, 0.0007, 0.007813, 0.00015},
          {{.kind = PairPotential::hertzian}, 1.0, 0.01, 0.05, 0.03682, 0.0005, 0.006029, 0.00012},
          {{.kind = PairPotential::wca}, 0.6, 1.0, 0.0025, 2.298, 0.04, 0.2089, 0.006},
          {reference::table_of({.kind = PairPotential::wca}, 0.75, 60), 0.6, 1.0, 0.0025, 2.298, 0.04, 0.2089, 0.006}};
}

EngineSettings settings_of(Fluid const& fluid) {
  return {.kind = "soft",
          .time_step = fluid.time_step,
          .threads = 1,
          .thermostat = {.kind = ThermostatKind::langevin, .temperature = fluid.temperature, .friction = 1.0},
          .potential = fluid.potential};
}

TEST(SoftFluid, HasThePressureAndEnergyOfAnIndependentProgram) {
  for (Fluid const& of : fluids()) {
    State state = fluid(of.density, of.temperature);
    EngineSettings const settings = settings_of(of);
    auto const engine = make_engine(settings, state);
    Counters counters;
    auto const count = static_cast<double>(state.agents.size());
    std::uint64_t const between = of.density < 1.0 ? 40 : 10;
    engine->advance(state, counters, {.step = 100 * between});
    PairLaw const law(of.potential);
    std::vector<double> pressures;
    std::vector<double> energies;
    std::vector<double> kinetic;
    for (int block = 0; block < 20; ++block) {
      double virial = 0.0;
      double energy = 0.0;
      double motion = 0.0;
      constexpr int samples = 30;
      for (int k = 0; k < samples; ++k) {
        engine->advance(state, counters, {.step = state.clock.step + between});
        motion += kinetic_energy(state.agents) / (count * samples);
        for (std::size_t i = 0; i < state.agents.size(); ++i) {
          for (std::size_t j = 0; j < i; ++j) {
            double const square =
                squared_length(state.box.displacement(position(state.agents, i), position(state.agents, j)));
            if (square > 1.3) continue;
            virial += law.push(square, 1.0) * square / samples;
            energy += law.energy(square, 1.0) / (count * samples);
          }
        }
      }
      pressures.push_back(of.density * of.temperature + 0.5 * virial / state.box.area());
      energies.push_back(energy);
      kinetic.push_back(motion);
    }
    auto const pressure = reference::mean_of(pressures);
    auto const energy = reference::mean_of(energies);
    EXPECT_NEAR(pressure.value, of.pressure, of.pressure_tolerance) << pressure.error;
    EXPECT_NEAR(energy.value, of.energy, of.energy_tolerance) << energy.error;
    EXPECT_NEAR(reference::mean_of(kinetic).value / of.temperature, 1.0, 0.02);
  }
}

/// The root mean square of the change of the energy of each disk in kT, without a thermostat.
double energy_error(PotentialSettings const& potential, double time_step, double time) {
  State state = fluid(0.6, 1.0);
  EngineSettings settings{.kind = "soft", .time_step = 0.0025, .threads = 1, .potential = potential};
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = 2000});
  settings.time_step = time_step;
  auto const engine = make_engine(settings, state);
  std::vector<double> energies;
  double const end = state.clock.time + time;
  PairLaw const law(settings.potential);
  while (state.clock.time < end) {
    engine->advance(state, counters, {.step = state.clock.step + 7});
    double energy = kinetic_energy(state.agents);
    for (std::size_t i = 0; i < state.agents.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        energy += law.energy(
            squared_length(state.box.displacement(position(state.agents, i), position(state.agents, j))), 1.0);
      }
    }
    energies.push_back(energy / static_cast<double>(state.agents.size()));
  }
  auto const mean = reference::mean_of(energies);
  return mean.error * std::sqrt(static_cast<double>(energies.size()));
}

TEST(SoftFluid, OfNewtonKeepsItsEnergyToTheSquareOfTheStep) {
  PotentialSettings const wca{.kind = PairPotential::wca};
  for (PotentialSettings const& potential : {wca, reference::table_of(wca, 0.75, 60)}) {
    double const coarse = energy_error(potential, 0.004, 4.0);
    double const fine = energy_error(potential, 0.002, 4.0);
    EXPECT_LT(coarse, 1e-3);
    EXPECT_NEAR(coarse / fine, 4.0, 1.0) << coarse << " " << fine;
  }
}

/// The root mean square distance of disks that move by a table of WCA from those that move by the formula.
double distance_by_table(std::size_t rows) {
  State const start = fluid(0.6, 1.0);
  std::vector<State> ends;
  PotentialSettings const wca{.kind = PairPotential::wca};
  for (PotentialSettings const& potential : {wca, reference::table_of(wca, 0.75, rows)}) {
    State& state = ends.emplace_back(start);
    EngineSettings const settings{.kind = "soft", .time_step = 0.0025, .threads = 1, .potential = potential};
    Counters counters;
    make_engine(settings, state)->advance(state, counters, {.step = 200});
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < start.agents.size(); ++i) {
    squares += squared_length(start.box.displacement(position(ends[0].agents, i), position(ends[1].agents, i)));
  }
  return std::sqrt(squares / static_cast<double>(start.agents.size()));
}

TEST(SoftFluid, OfATableComesNearerToThePathsOfItsPotentialWithMoreRows) {
  double const coarse = distance_by_table(100);
  double const fine = distance_by_table(200);
  EXPECT_LT(coarse, 1e-3);
  // Forces have errors of the third order of the spacing, and their integrals of the fourth.
  EXPECT_LT(fine, coarse / 6.0) << coarse << " " << fine;
}

/// The mean squared displacement of free disks after so many steps, over that of the formula, with its error.
void expect_free_displacement(EngineSettings settings, std::uint64_t steps, double expected, bool is_at_rest) {
  std::uint64_t const count = 20'000;
  double const spacing = 100.0;
  double const side = spacing * 142.0;
  State start = make_start(Box(side, side, Edge::periodic),
                           {.count = count, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square}, 5);
  if (!is_at_rest) draw_velocities(start, {.kind = VelocityKind::maxwell});
  State state = start;
  settings.kind = "soft";
  settings.potential = {.kind = PairPotential::wca};
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = steps});
  std::vector<double> squares;
  for (std::size_t i = 0; i < count; ++i) {
    squares.push_back(squared_length(state.box.displacement(position(start.agents, i), position(state.agents, i))));
  }
  auto const mean = reference::mean_of(squares);
  EXPECT_NEAR(mean.value, expected, 4.0 * mean.error);
}

TEST(FreeSoftDisks, WithoutInertiaDiffuse) {
  // D = kT/(m γ) = 0.25, for any step.
  EngineSettings const settings{
      .time_step = 0.01,
      .threads = 2,
      .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.5, .friction = 2.0}};
  expect_free_displacement(settings, 200, 4.0 * 0.25 * 2.0, true);
}

TEST(FreeSoftDisks, ThatPropelThemselvesPersist) {
  double const v = 3.0;
  double const rotation = 1.5;
  double const step = 0.01;
  std::uint64_t const steps = 100;
  EngineSettings settings{.time_step = step,
                          .threads = 2,
                          .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.5, .friction = 2.0},
                          .propulsion = {.speed = v, .rotational_diffusion = rotation}};
  // Headings turn between steps: a sum over pairs of steps of q^|k − l|.
  double const q = std::exp(-rotation * step);
  auto const k = static_cast<double>(steps);
  double const swum =
      v * v * step * step * (k * (1.0 + q) / (1.0 - q) - 2.0 * q * (1.0 - std::pow(q, k)) / ((1.0 - q) * (1.0 - q)));
  expect_free_displacement(settings, steps, 4.0 * 0.25 * k * step + swum, true);
}

TEST(FreeSoftDisks, InALangevinBathDiffuseAfterTheyHaveForgottenTheirVelocities) {
  double const friction = 2.0;
  double const temperature = 0.5;
  double const step = 0.1;
  State state = make_start(Box(14200.0, 14200.0, Edge::periodic),
                           {.count = 20'000, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square}, 5);
  EngineSettings const settings{
      .kind = "soft",
      .time_step = step,
      .threads = 2,
      .thermostat = {.kind = ThermostatKind::langevin, .temperature = temperature, .friction = friction},
      .potential = {.kind = PairPotential::wca}};
  auto const engine = make_engine(settings, state);
  Counters counters;
  // From rest the temperature rises as 1 − e^(−2γt), exactly.
  engine->advance(state, counters, {.step = 3});
  auto const count = static_cast<double>(state.agents.size());
  double const warm = temperature * (1.0 - std::exp(-2.0 * friction * 0.3));
  EXPECT_NEAR(kinetic_energy(state.agents) / count / warm, 1.0, 4.0 / std::sqrt(count));
  engine->advance(state, counters, {.step = 60});
  EXPECT_NEAR(kinetic_energy(state.agents) / count / temperature, 1.0, 4.0 / std::sqrt(count));
  // The velocities of BAOAB lose e^(−γ dt) of their correlation in a step, and a path is half of both velocities:
  // D = (kT/m)(dt/2) coth(γ dt/2).
  State const from = state;
  std::uint64_t const steps = 200;
  engine->advance(state, counters, {.step = 60 + steps});
  std::vector<double> squares;
  for (std::size_t i = 0; i < state.agents.size(); ++i) {
    squares.push_back(squared_length(state.box.displacement(position(from.agents, i), position(state.agents, i))));
  }
  double const q = std::exp(-friction * step);
  auto const k = static_cast<double>(steps);
  // Velocities before and after the noise of steps l and l + n are correlated as q^(n − 1), q^n and q^(n + 1).
  double const half = 0.5 * step;
  double const same = 2.0 * temperature * (1.0 + q) * half * half * 2.0;
  double const next = 2.0 * temperature * (1.0 + q) * (1.0 + q) * half * half;
  double const expected =
      k * same + 2.0 * next * ((k - 1.0) / (1.0 - q) - q * (1.0 - std::pow(q, k - 1.0)) / ((1.0 - q) * (1.0 - q)));
  auto const mean = reference::mean_of(squares);
  EXPECT_NEAR(mean.value, expected, 4.0 * mean.error);
}

/// The average of a quantity of a run.
double result_of(RunResult const& run, std::string const& name) {
  for (NamedEstimate const& result : run.results) {
    if (result.name == name) return result.estimate.value;
  }
  ADD_FAILURE() << name;
  return 0.0;
}

TEST(FreeSoftDisks, InAFlowSpreadAlongItWithTheCubeOfTime) {
  // ⟨(x − x₀ − γ̇ y₀ t)²⟩ = 2 D t (1 + γ̇² t²/3), D = kT/(m γ) = 0.25.
  double const rate = 1.5;
  double const time = 2.0;
  State const start = make_start(Box(2000.0, 2000.0, Edge::periodic),
                                 {.count = 4000, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square}, 5);
  State state = start;
  EngineSettings const settings{.kind = "soft",
                                .time_step = 0.01,
                                .threads = 2,
                                .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.5, .friction = 2.0},
                                .flow = {.shear_rate = rate}};
  Counters counters;
  make_engine(settings, state)->advance(state, counters, {.step = 200});
  std::vector<double> along, across;
  for (std::size_t i = 0; i < start.agents.size(); ++i) {
    Vector const from = position(start.agents, i);
    Vector const to = reference::unwrapped_place(state, i);
    along.push_back(std::pow(to.x - from.x - rate * from.y * time, 2));
    across.push_back(std::pow(to.y - from.y, 2));
  }
  auto const x = reference::mean_of(along);
  auto const y = reference::mean_of(across);
  EXPECT_NEAR(x.value, 2.0 * 0.25 * time * (1.0 + rate * rate * time * time / 3.0), 4.0 * x.error);
  EXPECT_NEAR(y.value, 2.0 * 0.25 * time, 4.0 * y.error);
}

struct SteadyFlow {
  double packing_fraction;
  double shear_rate;
  double stress;
  double stress_error;
  double pressure;
  double pressure_error;
};

/// Computed once by an independent program: 256 harmonic disks, 1 : 1.4, with Durian's drag against the flow, kT = 0.
/// Errors are those of the blocks of one run, twice.
std::vector<SteadyFlow> steady_flows() {
  return {{0.82, 1e-3, 1.189e-3, 2.8e-5, 4.20e-3, 6e-5},
          {0.8435, 1e-3, 1.894e-3, 5e-5, 8.08e-3, 1.6e-4},
          {0.86, 1e-3, 2.51e-3, 8e-5, 1.185e-2, 2.8e-4}};
}

TEST(SoftFlow, HasTheStressOfAnIndependentProgram) {
  double last = 0.0;
  for (SteadyFlow const& of : steady_flows()) {
    double const side = std::sqrt(128.0 * 0.25 * std::numbers::pi * 2.96 / of.packing_fraction);
    DisksSettings disks{.count = 256, .packing_fraction = {}, .radius = 0.5, .start = StartKind::uniform};
    disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}};
    State state = make_start(Box(side, side, Edge::periodic), disks, 1);
    std::ranges::fill(state.agents.column<VelocityX>(), 0.0);
    std::ranges::fill(state.agents.column<VelocityY>(), 0.0);
    EngineSettings const settings{
        .kind = "soft",
        .time_step = 0.2,
        .threads = 1,
        .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.0, .friction = 1.0},
        .flow = {.shear_rate = of.shear_rate}};
    auto const engine = make_engine(settings, state);
    Counters counters;
    engine->advance(state, counters, {.step = 10'000});
    DynamicsTraits const traits{.keeps_counters = false,
                                .halts_moves = false,
                                .has_impulses = false,
                                .potential = settings.potential,
                                .thermostat = settings.thermostat};
    Stress stress(traits);
    std::vector<double> row(5);
    stress.begin(Snapshot(state, counters));
    std::vector<double> shear, pressure;
    for (int block = 0; block < 20; ++block) {
      double sum_of_stress = 0.0;
      double sum_of_pressure = 0.0;
      constexpr int samples = 40;
      for (int k = 0; k < samples; ++k) {
        engine->advance(state, counters, {.step = state.clock.step + 50});
        stress.sample(Snapshot(state, counters), row, false);
        sum_of_pressure += row[1] / samples;
        sum_of_stress += row[3] / samples;
      }
      shear.push_back(sum_of_stress);
      pressure.push_back(sum_of_pressure);
    }
    auto const xy = reference::mean_of(shear);
    auto const p = reference::mean_of(pressure);
    EXPECT_NEAR(xy.value, of.stress, 4.0 * std::hypot(xy.error, of.stress_error)) << of.packing_fraction;
    EXPECT_NEAR(p.value, of.pressure, 4.0 * std::hypot(p.error, of.pressure_error)) << of.packing_fraction;
    EXPECT_GT(xy.value, last);
    last = xy.value;
  }
}

TEST(SoftSwimmers, AreSlowedDownByOthersAndPushThem) {
  // An independent program: overdamped WCA disks, kT = mγ = σ = 1, D_R = 3, Euler steps of 5e-5, N = 400.
  struct Swimmers {
    double packing_fraction;
    double speed;
    double effective_speed;
    double virial_pressure;
    double tolerance_of_pressure;
  };
  for (Swimmers const& of : {Swimmers{0.2, 10.0, 0.777, 0.398, 0.04}, Swimmers{0.4, 40.0, 0.569, 6.37, 0.35}}) {
    Configuration configuration;
    double const side = std::sqrt(400.0 * 0.25 * std::numbers::pi / of.packing_fraction);
    configuration.box = {.edge = Edge::periodic, .side = side};
    configuration.disks = {.count = 400, .packing_fraction = {}, .radius = 0.5, .start = StartKind::random};
    configuration.engine = {.kind = "soft",
                            .time_step = 5e-5,
                            .speed = 1.0,
                            .threads = 2,
                            .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 1.0, .friction = 1.0},
                            .propulsion = {.speed = of.speed, .rotational_diffusion = 3.0},
                            .potential = {.kind = PairPotential::wca, .energy = std::max(of.speed, 24.0) / 24.0}};
    configuration.run.steps = 24'000;
    configuration.observe.every = 100;
    configuration.observe.structure_every = 0;
    RunResult const run = simulate(set_up(configuration));
    double const thermal = 400.0 / (side * side);
    EXPECT_NEAR(result_of(run, "effective_swim_speed"), of.effective_speed, 0.02);
    EXPECT_NEAR(result_of(run, "pressure") - thermal, of.virial_pressure, of.tolerance_of_pressure);
  }
}

}  // namespace
}  // namespace gridlock
