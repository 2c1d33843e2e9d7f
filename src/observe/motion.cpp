#include "observe/motion.hpp"

#include <array>

#include "core/temperature.hpp"
#include "gridlock/core/disks.hpp"
#include "observe/exact_sums.hpp"

namespace gridlock {

namespace {

MeasuredMotion measure(Snapshot const& now) {
  auto const mass = now.agents.column<Mass>();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  auto const twice_energy = [&](std::size_t i) { return mass[i] * squared_length({velocity_x[i], velocity_y[i]}); };
  if (!now.box.is_periodic()) {
    std::array<ExactSum, 1> sum;
    add_terms(sum, now.agents.size(), [&](std::size_t i) { return std::array{twice_energy(i)}; });
    now.add_up(sum);
    double const energy = 0.5 * sum[0].value();
    return {energy, temperature_between_walls(now.count(), energy)};
  }
  std::array<ExactSum, 4> sums;
  add_terms(sums, now.agents.size(), [&](std::size_t i) {
    return std::array{twice_energy(i), mass[i] * velocity_x[i], mass[i] * velocity_y[i], mass[i]};
  });
  now.add_up(sums);
  double const energy = 0.5 * sums[0].value();
  return {energy, periodic_temperature(now.count(), energy, {sums[1].value(), sums[2].value()}, sums[3].value())};
}

MeasuredMotion const& motion_of(Snapshot const& now) {
  if (!now.motion) now.motion = measure(now);
  return *now.motion;
}

}  // namespace

double measured_kinetic_energy(Snapshot const& now) { return motion_of(now).kinetic_energy; }

std::optional<double> measured_temperature(Snapshot const& now) { return motion_of(now).temperature; }

}  // namespace gridlock
