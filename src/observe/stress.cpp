#include "observe/stress.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "gridlock/observe/pairs.hpp"
#include "observe/motion.hpp"

namespace gridlock {

std::vector<ColumnInfo> stress_columns() {
  return {{"stress_xx", "mass / time²", "Stress along x, tension positive; of hard disks the mean between samples."},
          {"stress_xy", "mass / time²", "Shear stress; of hard disks the mean since the sample before."},
          {"stress_yy", "mass / time²", "Stress along y, tension positive; of hard disks the mean between samples."}};
}

Stress::Stress(DynamicsTraits const& dynamics) : dynamics_(dynamics), law_(*dynamics.potential) {}

void Stress::begin(Snapshot const& /*start*/) {
  std::vector<ColumnInfo> columns{
      {"potential_energy", "mass · length² / time²", "Total energy of all pairs of soft disks."},
      {"pressure", "mass / time²", "Pressure of soft disks: kinetic part and virial of all pairs."}};
  std::ranges::move(stress_columns(), std::back_inserter(columns));
  if (has_inertia()) {
    columns.push_back({"total_energy", "mass · length² / time²", "Kinetic energy and potential energy of soft disks."});
  }
  if (dynamics_.propels) {
    columns.push_back(
        {"effective_swim_speed", "",
         "Displacement of self-propelled disks along their headings, as a fraction of that of free disks."});
  }
  reset(std::move(columns));
}

Stress::PairSums Stress::sum_over_pairs(Snapshot const& now) const {
  auto const radius = now.agents.column<Radius>();
  auto const mass = now.agents.column<Mass>();
  auto const vx = now.agents.column<VelocityX>();
  auto const vy = now.agents.column<VelocityY>();
  auto const velocity = [&](std::size_t k) { return Vector{vx[k], vy[k]}; };
  std::array<ExactSum, 5> sums;
  now.pairs(law_.cutoff() * largest_contact_distance(radius), [&](NearPair const& pair) {
    std::size_t const i = pair.i;
    std::size_t const j = pair.j;
    Vector const r = pair.separation;
    double const square = squared_length(r);
    double const sigma = radius[i] + radius[j];
    double const push = law_.push(square, sigma);
    Vector force = push * r;
    if (dynamics_.pair_drag.exists() && square > 0.0 && square < sigma * sigma) {
      Vector const flow{dynamics_.flow.shear_rate * r.y, 0.0};
      force = force + dynamics_.pair_drag.force(r, velocity(j) - velocity(i) + flow);
    }
    sums[0].add(law_.energy(square, sigma));
    sums[1].add(-force.x * r.x);
    sums[2].add(-force.x * r.y);
    sums[3].add(-force.y * r.y);
    if (dynamics_.propels) {
      sums[4].add(push * (dot(r, velocity(j)) / mass[j] - dot(r, velocity(i)) / mass[i]));
    }
  });
  return {.energy = sums[0].value(),
          .stress_xx = sums[1].value(),
          .stress_xy = sums[2].value(),
          .stress_yy = sums[3].value(),
          .power = sums[4].value()};
}

void Stress::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  auto const mass = now.agents.column<Mass>();
  auto const vx = now.agents.column<VelocityX>();
  auto const vy = now.agents.column<VelocityY>();
  PairSums const pairs = sum_over_pairs(now);
  std::array<double, 3> kinetic{};
  if (has_inertia()) {
    kinetic = now.sum([&](std::size_t i) {
      double const m = is_fixed(mass[i]) ? 0.0 : mass[i];
      return std::array{m * vx[i] * vx[i], m * vx[i] * vy[i], m * vy[i] * vy[i]};
    });
  } else {
    double const thermal = static_cast<double>(count_of_moving(now)) * *dynamics_.thermostat.temperature;
    kinetic = {thermal, 0.0, thermal};
  }
  double const area = now.box.area();
  double const xx = (pairs.stress_xx - kinetic[0]) / area;
  double const xy = (pairs.stress_xy - kinetic[1]) / area;
  double const yy = (pairs.stress_yy - kinetic[2]) / area;
  std::size_t column = 0;
  auto const put = [&](double value) {
    row[column] = value;
    if (counts_for_average) average(column, value);
    ++column;
  };
  put(pairs.energy);
  put(-0.5 * (xx + yy));
  put(xx);
  put(xy);
  put(yy);
  if (has_inertia()) put(pairs.energy + measured_kinetic_energy(now));
  if (!dynamics_.propels) return;
  PropulsionSettings const& propulsion = dynamics_.propulsion;
  double const if_free = *dynamics_.thermostat.friction * propulsion.speed * propulsion.speed;
  put(1.0 + pairs.power / (if_free * static_cast<double>(now.count())));
}

}  // namespace gridlock
