#include "gridlock/core/disks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridlock {

RadiusRange radius_range(Disks const& disks) {
  if (disks.empty()) return {};
  auto const [smallest, largest] = std::ranges::minmax(disks.column<Radius>());
  return {smallest, largest};
}

double kinetic_energy(Disks const& disks) {
  auto const mass = disks.column<Mass>();
  double twice = 0.0;
  for (std::size_t i = 0; i < disks.size(); ++i) twice += mass[i] * squared_length(velocity(disks, i));
  return 0.5 * twice;
}

Vector momentum(Disks const& disks) {
  auto const mass = disks.column<Mass>();
  Vector sum;
  for (std::size_t i = 0; i < disks.size(); ++i) sum = sum + mass[i] * velocity(disks, i);
  return sum;
}

double largest_speed(Disks const& disks) {
  double largest = 0.0;
  for (std::size_t i = 0; i < disks.size(); ++i) largest = std::max(largest, squared_length(velocity(disks, i)));
  return std::sqrt(largest);
}

double covered_area(Disks const& disks) {
  double sum = 0.0;
  for (double const r : disks.column<Radius>()) sum += r * r;
  return std::numbers::pi * sum;
}

}  // namespace gridlock
