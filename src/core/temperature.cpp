#include "core/temperature.hpp"

#include <algorithm>
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

std::optional<double> temperature_without_drift(Box const& box, std::size_t agents, double kinetic_energy,
                                                Vector momentum, double mass) {
  // A single disk that moves in one direction between walls has the energy of that direction.
  bool const has_walls = box.has_walls();
  if (agents < 2 && !(agents == 1 && has_walls)) return std::nullopt;
  if (!box.is_periodic_x()) momentum.x = 0.0;
  if (!box.is_periodic_y()) momentum.y = 0.0;
  double const drift_energy = 0.5 * squared_length(momentum) / mass;
  double const lost = has_walls ? 0.5 : 1.0;  // half the degrees of freedom that momentum takes
  // For disks that all move alike the two energies differ by rounding only, and the difference may be negative.
  return std::max(0.0, kinetic_energy - drift_energy) / (static_cast<double>(agents) - lost);
}

std::optional<double> temperature(Box const& box, AgentsView const& agents) {
  double const energy = kinetic_energy(agents);
  std::size_t const fixed = count_of_fixed(agents.column<Mass>());
  if (!box.has_images() || fixed > 0) return temperature_between_walls(agents.size() - fixed, energy);
  return temperature_without_drift(box, agents.size(), energy, momentum(agents), total_mass(agents));
}

double mean_mass(Disks const& disks) {
  double sum = 0.0;
  for (double const mass : disks.column<Mass>()) sum += is_fixed(mass) ? 0.0 : mass;
  return sum / static_cast<double>(disks.size() - count_of_fixed(disks));
}

}  // namespace gridlock
