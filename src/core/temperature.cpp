#include "core/temperature.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gridlock {

namespace {

double total_mass(AgentsView const& agents) {
  double sum = 0.0;
  for (double const mass : agents.column<Mass>()) sum += mass;
  return sum;
}

}  // namespace

std::optional<double> temperature_between_walls(std::size_t agents, double kinetic_energy) {
  return agents > 0 ? std::optional(kinetic_energy / static_cast<double>(agents)) : std::nullopt;
}

std::optional<double> periodic_temperature(std::size_t agents, double kinetic_energy, Vector momentum, double mass) {
  if (agents < 2) return std::nullopt;
  double const drift_energy = 0.5 * squared_length(momentum) / mass;
  // For disks that all move alike the two energies differ by rounding only, and the difference may be negative.
  return std::max(0.0, kinetic_energy - drift_energy) / (static_cast<double>(agents) - 1.0);
}

std::optional<double> temperature(Box const& box, AgentsView const& agents) {
  double const energy = kinetic_energy(agents);
  auto const masses = agents.column<Mass>();
  auto const fixed = static_cast<std::size_t>(std::ranges::count_if(masses, [](double m) { return std::isinf(m); }));
  if (!box.is_periodic() || fixed > 0) return temperature_between_walls(agents.size() - fixed, energy);
  return periodic_temperature(agents.size(), energy, momentum(agents), total_mass(agents));
}

}  // namespace gridlock
