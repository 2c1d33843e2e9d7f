#include "observe/motion.hpp"

#include <array>

#include "core/temperature.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

namespace {

MeasuredMotion measure(Snapshot const& now) {
  auto const mass = now.agents.column<Mass>();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  auto const twice_energy = [&](std::size_t i) { return mass[i] * squared_length({velocity_x[i], velocity_y[i]}); };
  if (!now.box.is_periodic()) {
    double const energy = 0.5 * now.sum(twice_energy);
    return {energy, temperature_between_walls(now.count(), energy)};
  }
  auto const [energies, momentum_x, momentum_y, all_mass] = now.sum([&](std::size_t i) {
    return std::array{twice_energy(i), mass[i] * velocity_x[i], mass[i] * velocity_y[i], mass[i]};
  });
  double const energy = 0.5 * energies;
  return {energy, periodic_temperature(now.count(), energy, {momentum_x, momentum_y}, all_mass)};
}

MeasuredMotion const& motion_of(Snapshot const& now) {
  if (!now.motion) now.motion = measure(now);
  return *now.motion;
}

}  // namespace

double measured_kinetic_energy(Snapshot const& now) { return motion_of(now).kinetic_energy; }

std::optional<double> measured_temperature(Snapshot const& now) { return motion_of(now).temperature; }

}  // namespace gridlock
