#include "engine/soft/moves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/decay.hpp"
#include "core/normal_pairs.hpp"

namespace gridlock::soft {

namespace {

constexpr std::size_t disks_at_once = 64;

/// Calls move_disk(row, noise) for each disk of a band, with two normal numbers.
template <class MoveDisk>
void with_noise(MoveRule const& rule, std::uint64_t step, Band const& band, Disks const& disks, MoveDisk move_disk) {
  std::array<Id, disks_at_once> ids;
  std::array<Vector, disks_at_once> noise;
  for (std::size_t first = band.first; first < band.end; first += disks_at_once) {
    std::size_t const count = std::min(disks_at_once, band.end - first);
    for (std::size_t k = 0; k < count; ++k) ids[k] = disks.identities[first + k].id;
    draw_normal_pairs(rule.seed, step, std::span(ids).first(count), Purpose::thermostat, std::span(noise).first(count));
    for (std::size_t k = 0; k < count; ++k) move_disk(first + k, noise[k]);
  }
}

/// Puts disks to their new places, and remembers the longest ways.
class Mover {
 public:
  Mover(MoveRule const& rule, Disks& disks) : box_(rule.box), strain_(rule.strain), disks_(disks) {}

  /// Moves a disk along its own way, and along x by what a flow carries it.
  void put(std::size_t row, Vector way, double carried = 0.0) {
    double const squared_step = squared_length(way);
    // False also for a way that is not a number.
    if (!(squared_step <= ways_.squared_step)) {
      constexpr double infinite = std::numeric_limits<double>::infinity();
      ways_.squared_step = squared_step < infinite ? squared_step : infinite;
      ways_.row = row;
    }
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const place = box_.wrap(disks_.places[row] + Vector{way.x + carried, way.y}, crossed_x, crossed_y);
    disks_.places[row] = place;
    if ((crossed_x | crossed_y) != 0) [[unlikely]] {
      disks_.identities[row].image_x += crossed_x;
      disks_.identities[row].image_y += crossed_y;
    }
    ways_.squared_drift = std::max(ways_.squared_drift, squared_length(drift(disks_.motions[row].listed_at, place)));
  }
  [[nodiscard]] LongestWays const& ways() const { return ways_; }

 private:
  /// Returns the displacement since the lists were made, without that of a homogeneous flow.
  [[nodiscard]] Vector drift(Vector listed_at, Vector place) const {
    if (strain_ == 0.0) return box_.displacement_inside(listed_at, place);
    return box_.displacement({listed_at.x + strain_ * listed_at.y, listed_at.y}, place);
  }

  Box const box_;
  double const strain_;
  Disks& disks_;
  LongestWays ways_;
};

/// Returns how far the flow carries a disk that begins at height y and moves by `rise`, in a time.
double carried(MoveRule const& rule, double time, double y, double rise) {
  return rule.shear_rate * time * (y + 0.5 * rise);
}

LongestWays move_by_inertia(MoveRule const& rule, Band const& band, Disks& disks) {
  Mover mover(rule, disks);
  for (std::size_t row = band.first; row < band.end; ++row) {
    Motion& motion = disks.motions[row];
    motion.velocity = motion.velocity + motion.kick * motion.force;
    mover.put(row, rule.duration * motion.velocity);
  }
  return mover.ways();
}

/// Lets a disk fly straight for a time, and takes the new flow at its end from its velocity. Returns the way without
/// what the flow carries, and adds that to `carry`.
Vector fly(MoveRule const& rule, double time, double y, Vector& velocity, double& carry) {
  double const rise = time * velocity.y;
  // The speed of the flow grows along the way by as much as the velocity relative to it falls.
  Vector const way{time * (velocity.x - 0.5 * rule.shear_rate * rise), rise};
  carry += carried(rule, time, y, rise);
  velocity.x -= rule.shear_rate * rise;
  return way;
}

/// Newton's equations or a bath, in a flow.
LongestWays move_in_flow(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks) {
  Mover mover(rule, disks);
  double const half = 0.5 * rule.duration;
  bool const has_bath = rule.thermostat == ThermostatKind::langevin;
  with_noise(rule, step, band, disks, [&](std::size_t row, Vector noise) {
    Motion& motion = disks.motions[row];
    motion.velocity = motion.velocity + motion.kick * motion.force;
    double const y = disks.places[row].y;
    double carry = 0.0;
    Vector const first = fly(rule, half, y, motion.velocity, carry);
    if (has_bath) motion.velocity = rule.keep * motion.velocity + motion.noise * noise;
    Vector const second = fly(rule, half, y + first.y, motion.velocity, carry);
    mover.put(row, first + second, carry);
  });
  return mover.ways();
}

LongestWays move_in_bath(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks) {
  Mover mover(rule, disks);
  double const half = 0.5 * rule.duration;
  with_noise(rule, step, band, disks, [&](std::size_t row, Vector noise) {
    Motion& motion = disks.motions[row];
    Vector const before = motion.velocity + motion.kick * motion.force;
    motion.velocity = rule.keep * before + motion.noise * noise;
    mover.put(row, half * (before + motion.velocity));
  });
  return mover.ways();
}

LongestWays move_without_inertia(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks) {
  Mover mover(rule, disks);
  HeadingStep const of_step = rule.heading.is_on() ? heading_step(rule.heading, step) : HeadingStep{};
  with_noise(rule, step, band, disks, [&](std::size_t row, Vector noise) {
    Motion& motion = disks.motions[row];
    if (rule.heading.is_on()) {
      motion.velocity = turned_velocity(of_step, disks.identities[row].id_index, motion.velocity);
    }
    Vector const way = rule.duration * motion.velocity + motion.kick * motion.force + motion.noise * noise;
    if (rule.shear_rate == 0.0) return mover.put(row, way);
    mover.put(row, way, carried(rule, rule.duration, disks.places[row].y, way.y));
  });
  return mover.ways();
}

}  // namespace

void LongestWays::add(LongestWays const& other) {
  if (other.squared_step > squared_step) {
    squared_step = other.squared_step;
    row = other.row;
  }
  squared_drift = std::max(squared_drift, other.squared_drift);
}

MoveRule move_rule(EngineSettings const& settings, State const& state) {
  double const duration = step_duration(settings, state);
  double const friction = settings.thermostat.friction.value_or(0.0);
  return {.box = state.box,
          .duration = duration,
          .thermostat = settings.thermostat.kind,
          .friction = friction,
          .temperature = settings.thermostat.temperature.value_or(0.0),
          .keep = decay(friction * duration),
          .seed = state.seed,
          .heading = heading_rule(settings.propulsion, duration, state.seed),
          .shear_rate = settings.flow.shear_rate,
          .strain = 0.0};
}

void prepare(MoveRule const& rule, Disks& disks) {
  bool const is_overdamped = rule.thermostat == ThermostatKind::overdamped;
  double const square = rule.heading.speed * rule.heading.speed;
  for (std::size_t row = 0; row < disks.size(); ++row) {
    Identity const& identity = disks.identities[row];
    Motion& motion = disks.motions[row];
    if (!is_overdamped) {
      motion.kick = 0.5 * rule.duration / identity.mass;
      motion.noise = std::sqrt(rule.temperature * (1.0 - rule.keep * rule.keep) / identity.mass);
      continue;
    }
    motion.kick = rule.duration / (identity.mass * rule.friction);
    motion.noise = std::sqrt(2.0 * rule.temperature * motion.kick);
    if (!rule.heading.is_on()) {
      motion.velocity = {};
    } else if (std::abs(squared_length(motion.velocity) - square) > 1e-12 * square) {
      motion.velocity = rule.heading.speed * first_heading(rule.seed, identity.id, motion.velocity);
    }
  }
}

LongestWays move(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks) {
  if (rule.shear_rate != 0.0 && rule.thermostat != ThermostatKind::overdamped) {
    return move_in_flow(rule, step, band, disks);
  }
  switch (rule.thermostat) {
    case ThermostatKind::langevin:
      return move_in_bath(rule, step, band, disks);
    case ThermostatKind::overdamped:
      return move_without_inertia(rule, step, band, disks);
    default:
      return move_by_inertia(rule, band, disks);
  }
}

void end_step(MoveRule const& rule, Band const& band, Disks& disks) {
  if (rule.thermostat == ThermostatKind::overdamped) return;
  for (std::size_t row = band.first; row < band.end; ++row) {
    Motion& motion = disks.motions[row];
    motion.velocity = motion.velocity + motion.kick * motion.force;
  }
}

}  // namespace gridlock::soft
