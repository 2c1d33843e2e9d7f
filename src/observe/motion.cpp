#include "observe/motion.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/temperature.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

namespace {

MeasuredMotion measure(Snapshot const& now) {
  auto const mass = now.agents.column<Mass>();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  std::array<std::uint64_t, 1> fixed{count_of_fixed(mass)};
  now.counts(fixed);
  std::size_t const moving = now.count() - fixed[0];
  auto const twice_energy = [&](std::size_t i) {
    return is_fixed(mass[i]) ? 0.0 : mass[i] * squared_length({velocity_x[i], velocity_y[i]});
  };
  if (!now.box.has_images() || fixed[0] > 0) {
    double const energy = 0.5 * now.sum(twice_energy);
    return {energy, temperature_between_walls(moving, energy), moving};
  }
  auto const [energies, momentum_x, momentum_y, all_mass] = now.sum([&](std::size_t i) {
    return std::array{twice_energy(i), mass[i] * velocity_x[i], mass[i] * velocity_y[i], mass[i]};
  });
  double const energy = 0.5 * energies;
  return {energy, temperature_without_drift(now.box, moving, energy, {momentum_x, momentum_y}, all_mass), moving};
}

MeasuredMotion const& motion_of(Snapshot const& now) {
  if (!now.motion) now.motion = measure(now);
  return *now.motion;
}

}  // namespace

std::size_t count_of_moving(Snapshot const& now) { return motion_of(now).moving; }

double measured_kinetic_energy(Snapshot const& now) { return motion_of(now).kinetic_energy; }

std::optional<double> measured_temperature(Snapshot const& now) { return motion_of(now).temperature; }

}  // namespace gridlock
