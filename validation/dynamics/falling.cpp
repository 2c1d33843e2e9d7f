// Disks that fall on a hard floor: the force on it, and the equation of state at each height.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "dynamics/sections.hpp"
#include "gridlock/lattice/start.hpp"

namespace gridlock::validation {
namespace {

constexpr double gravity = 0.2;
constexpr double width = 15.0;
constexpr double height = 50.0;
constexpr double weight = 200.0 * gravity;

State heap(std::uint64_t seed) {
  return make_start(
      Box(width, height, Edge::periodic, Edge::wall),
      {.count = 200, .radius = 0.5, .start = StartKind::square, .region = {0.0, 0.0, width, height / 2.0}}, seed);
}

EngineSettings falling_with(ThermostatSettings const& thermostat) {
  EngineSettings settings = exact();
  settings.thermostat = thermostat;
  settings.gravity = {.y = -gravity};
  return settings;
}

/// Z of hard disks by the fit of Kolafa and Rottner (2006, Mol. Phys. 104, 3435), good to 10⁻⁵ up to φ = 0.67.
double compressibility(double packing_fraction) {
  double const x = packing_fraction / (1.0 - packing_fraction);
  double z = 0.0;
  for (double const coefficient :
       {0.000336036442, -0.00250795961, 0.00669011963, -0.00808881628, 0.00129187484, 0.0134816028, -0.0325578581,
        0.0504963915, -0.0526134737, 0.00181895291, 1.12801775, 2.0, 1.0}) {
    z = z * x + coefficient;
  }
  return z;
}

/// Returns how much larger the pressure of a fluid as dense as the mean is than the mean pressure, over that pressure. A
/// column of a fixed number of disks lacks the fluctuations δN of an open one. To first order this is ½ P''(ρ) ⟨δρ²⟩/P
/// with δρ = (∂ρ/∂μ) δN/(∂N/∂μ), ⟨δN²⟩ = ∂N/∂μ, ∂ρ/∂μ = ρ/P'(ρ), and ∂N/∂μ = W ρ/(m g) at the pressure of the floor.
double excess_of_fixed_number(double density) {
  constexpr double density_at_floor = 0.64078;  // of a fluid at the pressure N m g/W
  constexpr double step = 1e-3;
  auto const pressure = [](double rho) { return rho * compressibility(rho * pi / 4.0); };
  double const below = pressure(density - step);
  double const above = pressure(density + step);
  double const second = (above - 2.0 * pressure(density) + below) / (step * step);
  double const density_of_mu = density / ((above - below) / (2.0 * step));
  double const number_of_mu = width * density_at_floor / gravity;
  return 0.5 * second * density_of_mu * density_of_mu / number_of_mu / pressure(density);
}

struct Level {
  std::size_t height;
  double packing_fraction;
};
constexpr std::array levels{Level{1, 0.4640},  Level{2, 0.4634},  Level{3, 0.4708},  Level{4, 0.4697},
                            Level{5, 0.4621},  Level{6, 0.4521},  Level{8, 0.4314},  Level{10, 0.4092},
                            Level{12, 0.3852}, Level{16, 0.3306}, Level{20, 0.2691}, Level{24, 0.2025},
                            Level{28, 0.1372}};

/// Returns the pressures of floor and lid and the mean height; and for each level z the packing fraction from z − 1 to
/// z + 1, and the pressure of a fluid of that density over P = P_lid + m g ∫ρ dz' above z, which is exact.
Numbers falling_disks(ThermostatSettings const& thermostat, double time, std::uint64_t seed) {
  constexpr double equilibration = 600.0;
  constexpr double between_samples = 3.0;
  State state = heap(seed);
  auto const engine = make_engine(falling_with(thermostat), state);
  Counters counters;
  engine->advance(state, counters, {.time = equilibration});
  Counters const before = counters;
  std::vector<double> in_strip(static_cast<std::size_t>(height));  // disks whose centres are in strips of height 1
  double mean_height = 0.0;
  double const samples = std::floor(time / between_samples);
  for (double sample = 1.0; sample <= samples; ++sample) {
    engine->advance(state, counters, {.time = equilibration + sample * between_samples});
    for (double const y : state.agents.column<Y>()) {
      in_strip[static_cast<std::size_t>(y)] += 1.0 / samples;
      mean_height += y / (200.0 * samples);
    }
  }
  double const duration = samples * between_samples;
  double const lid = force_on(Counters::top, counters, before, duration) / width;
  Numbers numbers{force_on(Counters::bottom, counters, before, duration) / width, lid, mean_height};
  for (Level const& level : levels) {
    double const density = (in_strip[level.height - 1] + in_strip[level.height]) / (2.0 * width);
    double above = 0.0;
    for (std::size_t k = level.height; k < in_strip.size(); ++k) above += in_strip[k];
    numbers.push_back(density * pi / 4.0);
    numbers.push_back(density * compressibility(density * pi / 4.0) / (lid + gravity * above / width));
  }
  return numbers;
}

void column_of_disks() {
  constexpr double time = 12'000.0;
  struct Bath {
    std::string name;
    ThermostatSettings settings;
  };
  for (auto const& [name, thermostat] :
       {Bath{"brownian", {.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 3.0}},
        Bath{"andersen", {.kind = ThermostatKind::andersen, .temperature = 1.0, .rate = 1.0 / 3.0}}}) {
    auto const found =
        means(24, [&, thermostat = thermostat](std::uint64_t seed) { return falling_disks(thermostat, time, seed); });
    within_errors("pressure of the floor: " + name, found[0], {2.670, 0.004});
    within_errors("pressure of the lid: " + name, found[1], {0.00455, 0.00012});
    within_errors("mean height: " + name, found[2], {13.453, 0.011});
    for (std::size_t k = 0; k < levels.size(); ++k) {
      within_errors(fmt::format("phi at z {}: {}", levels[k].height, name), found[3 + 2 * k],
                    {levels[k].packing_fraction, 0.0005});
      if (levels[k].height < 5) continue;  // Disks lie in layers at the floor.
      within(fmt::format("P of a fluid as dense over P at z {}: {}", levels[k].height, name), found[4 + 2 * k],
             1.0 + excess_of_fixed_number(levels[k].packing_fraction * 4.0 / pi), 0.005);
    }
  }
}

/// Without a thermostat the floor carries the weight, but for the change of momentum, and the energy stays.
void balance_of_the_floor() {
  auto const found = means(24, [](std::uint64_t seed) -> Numbers {
    State state = heap(seed);
    Counters counters;
    make_engine(falling_with({.kind = ThermostatKind::brownian, .temperature = 1.0, .interval = 3.0}), state)
        ->advance(state, counters, {.time = 600.0});
    auto const energy = [&] {
      double sum = kinetic_energy(state.agents);
      for (double const y : state.agents.column<Y>()) sum += gravity * y;
      return sum;
    };
    double const energy_before = energy();
    double const momentum_before = momentum(state.agents).y;
    double const start = state.clock.time;
    Counters const before = counters;
    make_engine(falling_with({}), state)
        ->advance(state, counters, {.pair_collisions = before.pair_collisions + 100'000});
    double const time = state.clock.time - start;
    double const force =
        force_on(Counters::bottom, counters, before, time) - force_on(Counters::top, counters, before, time);
    double const exact = weight + (momentum(state.agents).y - momentum_before) / time;
    return {force / weight, std::abs(force / exact - 1.0), std::abs(energy() / energy_before - 1.0)};
  });
  within("floor less lid over the weight in 1e5 collisions", found[0], 1.0, 1e-3);
  within("the same with the change of momentum", found[1], 0.0, 1e-10);
  within("relative change of energy in 1e5 collisions", found[2], 0.0, 1e-10);
}

}  // namespace

void falling() {
  balance_of_the_floor();
  column_of_disks();
}

}  // namespace gridlock::validation
