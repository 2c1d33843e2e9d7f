// Soft disks in the engine `soft`: a fluid in a bath, its energy without one, and steady flow.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "dynamics/sections.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock::validation {
namespace {

/// The average of a quantity of a run.
double result_of(RunRecord const& run, std::string_view name) {
  return std::ranges::find(run.results, name, &NamedEstimate::name)->estimate.value;
}

/// 256 disks of diameter and mass 1.
struct Fluid {
  std::string name;
  PairPotential potential;
  double density;
  double temperature;
  double time_step;
  Estimate pressure;  ///< with the temperature of the bath
  Estimate energy;    ///< U/N
  Estimate kinetic_temperature;
  std::array<double, 3> energy_errors;  ///< r.m.s. of (H − ⟨H⟩)/N kT over t = 100, with steps of 2Δt, Δt and Δt/2
};

std::vector<Fluid> fluids() {
  return {{"harmonic",
           PairPotential::harmonic,
           1.0,
           0.01,
           0.05,
           {0.05637, 8e-5},
           {0.007813, 2.1e-5},
           {0.009984, 1.2e-5},
           {3.7e-4, 1.6e-4, 2e-5}},
          {"hertzian",
           PairPotential::hertzian,
           1.0,
           0.01,
           0.05,
           {0.03682, 4e-5},
           {0.006029, 1.3e-5},
           {0.009967, 9e-6},
           {1.2e-4, 2.6e-5, 6.5e-6}},
          {"wca",
           PairPotential::wca,
           0.6,
           1.0,
           0.0025,
           {2.298, 0.005},
           {0.2089, 8e-4},
           {0.997, 0.004},
           {2.7e-4, 4.9e-5, 1.7e-5}}};
}

constexpr double count = 256.0;

Configuration in_a_bath(Fluid const& of, std::uint64_t seed) {
  Configuration configuration;
  configuration.box = {.edge = Edge::periodic, .side = std::sqrt(count / of.density)};
  configuration.disks = {.count = 256, .packing_fraction = {}, .radius = 0.5, .start = StartKind::square};
  configuration.velocities = {.kind = VelocityKind::maxwell};
  configuration.engine = {
      .kind = "soft",
      .time_step = of.time_step,
      .threads = 1,
      .thermostat = {.kind = ThermostatKind::langevin, .temperature = of.temperature, .friction = 1.0},
      .potential = {.kind = of.potential}};
  configuration.run.seed = seed;
  configuration.observe.structure_every = 0;
  return configuration;
}

/// Returns the pressure with the temperature of the bath, the energy of pairs and the kinetic temperature.
Numbers fluid_in_a_bath(Fluid const& of, std::uint64_t seed) {
  Configuration configuration = in_a_bath(of, seed);
  configuration.run.time = 10'000.0 * of.time_step / 0.05;
  configuration.observe.every = 20;
  RunResult const run = simulate(set_up(configuration));
  double const kinetic = result_of(run, "kinetic_energy") / count;
  return {result_of(run, "pressure") + of.density * (of.temperature - kinetic),
          result_of(run, "potential_energy") / count, kinetic};
}

/// Returns the root mean square of the change of the energy without a bath, in kT a disk, for each length of step.
Numbers energy_errors(Fluid const& of, std::uint64_t seed) {
  Configuration configuration = in_a_bath(of, seed);
  configuration.run.time = 1000.0 * of.time_step / 0.05;
  configuration.observe.every = 1'000'000;
  State const start = simulate(set_up(configuration)).world;
  Numbers numbers;
  for (double const factor : {2.0, 1.0, 0.5}) {
    EngineSettings settings = configuration.engine;
    settings.thermostat = {};
    settings.time_step = factor * of.time_step;
    State state = start;
    auto engine = make_engine(settings, state);
    DiskSimulation simulation(std::move(engine), std::move(state));
    simulation.observe(
        configuration.observe,
        {.keeps_counters = false, .halts_moves = false, .has_impulses = false, .potential = settings.potential});
    auto const columns = simulation.columns();
    auto const energy = std::ranges::find(columns, "total_energy", &ColumnInfo::name) - columns.begin();
    std::vector<double> row(columns.size());
    std::vector<double> energies;
    double const end = start.clock.time + 100.0;
    while (simulation.clock().time < end) {
      simulation.advance({.step = simulation.clock().step + 7});
      simulation.sample(row, false);
      energies.push_back(row[static_cast<std::size_t>(energy)] / (count * of.temperature));
    }
    // The error of a mean of independent numbers, without the root of their number.
    numbers.push_back(reference::mean_of(energies).error * std::sqrt(static_cast<double>(energies.size())));
  }
  return numbers;
}

void fluids_of_soft_disks() {
  for (Fluid const& of : fluids()) {
    auto const bath = means(8, [&](std::uint64_t seed) { return fluid_in_a_bath(of, seed); });
    within_errors("pressure of soft disks: " + of.name, bath[0], of.pressure);
    within_errors("energy of a soft disk: " + of.name, bath[1], of.energy);
    within_errors("kinetic temperature of soft disks: " + of.name, bath[2], of.kinetic_temperature);
    constexpr std::uint64_t runs = 16;
    auto const newton = means(runs, [&](std::uint64_t seed) { return energy_errors(of, seed); });
    for (std::size_t k = 0; k < of.energy_errors.size(); ++k) {
      double const step = of.time_step * std::pow(2.0, 1.0 - static_cast<double>(k));
      within_scatter(fmt::format("energy error with steps of {}: {}", step, of.name), newton[k], runs,
                     of.energy_errors[k], 1);
    }
  }
}

/// 256 harmonic disks, 1 : 1.4, with Durian's drag against the flow, at kT = 0.
struct SteadyFlow {
  double packing_fraction;
  double rate;
  double strain;
  Estimate stress;  ///< errors of the independent program are those of the blocks of one run, twice
  Estimate pressure;
};

Numbers sheared_steadily(SteadyFlow const& of, std::uint64_t seed) {
  constexpr double time_step = 0.2;
  Configuration configuration;
  configuration.box = {.edge = Edge::periodic, .side = std::sqrt(128.0 * 0.25 * pi * 2.96 / of.packing_fraction)};
  configuration.disks = {.count = 256, .packing_fraction = {}, .radius = 0.5, .start = StartKind::uniform};
  configuration.disks.species = {{.fraction = 0.5}, {.fraction = 0.5, .size_ratio = 1.4}};
  configuration.velocities.max = 0.0;
  configuration.engine = {.kind = "soft",
                          .time_step = time_step,
                          .threads = 1,
                          .thermostat = {.kind = ThermostatKind::overdamped, .temperature = 0.0, .friction = 1.0},
                          .flow = {.shear_rate = of.rate}};
  configuration.run.seed = seed;
  configuration.run.steps = static_cast<std::uint64_t>(std::llround(of.strain / (of.rate * time_step)));
  configuration.observe.every = 50;
  configuration.observe.structure_every = 0;
  RunResult const run = simulate(set_up(configuration));
  return {result_of(run, "stress_xy"), result_of(run, "pressure")};
}

}  // namespace

void soft() { fluids_of_soft_disks(); }

void flow() {
  for (SteadyFlow const& of : {SteadyFlow{0.82, 1e-3, 20.0, {1.189e-3, 2.8e-5}, {4.20e-3, 6e-5}},
                               SteadyFlow{0.82, 1e-4, 8.0, {2.32e-4, 1.8e-5}, {9.4e-4, 8e-5}},
                               SteadyFlow{0.8435, 1e-3, 20.0, {1.894e-3, 5e-5}, {8.08e-3, 1.6e-4}},
                               SteadyFlow{0.8435, 1e-4, 8.0, {6.84e-4, 3.8e-5}, {3.85e-3, 1.2e-4}},
                               SteadyFlow{0.86, 1e-3, 20.0, {2.51e-3, 8e-5}, {1.185e-2, 2.8e-4}},
                               SteadyFlow{0.86, 1e-4, 8.0, {1.113e-3, 4.8e-5}, {7.66e-3, 1.6e-4}}}) {
    auto const found = means(4, [&](std::uint64_t seed) { return sheared_steadily(of, seed); });
    std::string const name = fmt::format("flow at phi {} rate {}", of.packing_fraction, of.rate);
    within_errors("stress: " + name, found[0], of.stress);
    within_errors("pressure: " + name, found[1], of.pressure);
  }
}

}  // namespace gridlock::validation
