#include "core/temperature.hpp"

#include <algorithm>

namespace gridlock {

namespace {

double total_mass(AgentsView const& agents) {
  double sum = 0.0;
  for (double const mass : agents.column<Mass>()) sum += mass;
  return sum;
}

}  // namespace

std::optional<double> temperature(Box const& box, AgentsView const& agents) {
  auto const n = static_cast<double>(agents.size());
  double const energy = kinetic_energy(agents);
  if (!box.is_periodic()) return n > 0.0 ? std::optional(energy / n) : std::nullopt;
  if (n < 2.0) return std::nullopt;
  double const drift_energy = 0.5 * squared_length(momentum(agents)) / total_mass(agents);
  // Disks that all move alike differ from their drift by rounding only, which may be negative.
  return std::max(0.0, energy - drift_energy) / (n - 1.0);
}

}  // namespace gridlock
