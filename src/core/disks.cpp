#include "gridlock/core/disks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/disks_overview.hpp"

namespace gridlock {

std::size_t count_of_fixed(Disks const& disks) { return count_of_fixed(disks.column<Mass>()); }

std::size_t count_of_fixed(std::span<double const> masses) {
  return static_cast<std::size_t>(std::ranges::count_if(masses, [](double mass) { return is_fixed(mass); }));
}

RadiusRange radius_range(Disks const& disks) {
  if (disks.empty()) return {};
  auto const [smallest, largest] = std::ranges::minmax(disks.column<Radius>());
  return {smallest, largest};
}

double largest_contact_distance(std::span<double const> radii) {
  double largest = 0.0;
  double second = 0.0;
  for (double const radius : radii) {
    second = std::max(second, std::min(largest, radius));
    largest = std::max(largest, radius);
  }
  return largest + second;
}

double largest_speed(Disks const& disks) {
  double largest = 0.0;
  for (std::size_t i = 0; i < disks.size(); ++i) largest = std::max(largest, squared_length(velocity(disks, i)));
  return std::sqrt(largest);
}

double kinetic_energy(AgentsView const& agents) {
  auto const mass = agents.column<Mass>();
  auto const velocity_x = agents.column<VelocityX>();
  auto const velocity_y = agents.column<VelocityY>();
  double twice = 0.0;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    if (!is_fixed(mass[i])) twice += mass[i] * squared_length({velocity_x[i], velocity_y[i]});
  }
  return 0.5 * twice;
}

Vector momentum(AgentsView const& agents) {
  auto const mass = agents.column<Mass>();
  auto const velocity_x = agents.column<VelocityX>();
  auto const velocity_y = agents.column<VelocityY>();
  Vector sum;
  for (std::size_t i = 0; i < agents.size(); ++i) {
    if (!is_fixed(mass[i])) sum = sum + mass[i] * Vector{velocity_x[i], velocity_y[i]};
  }
  return sum;
}

double covered_area(AgentsView const& agents) {
  double sum = 0.0;
  for (double const r : agents.column<Radius>()) sum += r * r;
  return std::numbers::pi * sum;
}

double mean_diameter(Disks const& disks) {
  double sum = 0.0;
  for (double const radius : disks.column<Radius>()) sum += 2.0 * radius;
  return sum / static_cast<double>(disks.size());
}

DisksOverview overview_of(Disks const& disks) {
  return {.count = disks.size(),
          .radii = radius_range(disks),
          .largest_speed = largest_speed(disks),
          .covered_area = covered_area(disks)};
}

void DisksOverview::add(DisksOverview const& others) {
  if (others.count == 0) return;
  radii = count == 0 ? others.radii
                     : RadiusRange{.smallest = std::min(radii.smallest, others.radii.smallest),
                                   .largest = std::max(radii.largest, others.radii.largest)};
  count += others.count;
  largest_speed = std::max(largest_speed, others.largest_speed);
  covered_area += others.covered_area;
}

}  // namespace gridlock
