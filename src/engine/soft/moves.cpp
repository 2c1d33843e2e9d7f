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
  Mover(Box const& box, Disks& disks) : box_(box), disks_(disks) {}

  void put(std::size_t row, Vector way) {
    double const squared_step = squared_length(way);
    // False also for a way that is not a number.
    if (!(squared_step <= ways_.squared_step)) {
      constexpr double infinite = std::numeric_limits<double>::infinity();
      ways_.squared_step = squared_step < infinite ? squared_step : infinite;
      ways_.row = row;
    }
    int crossed_x = 0;
    int crossed_y = 0;
    Vector const place = box_.wrap(disks_.places[row] + way, crossed_x, crossed_y);
    disks_.places[row] = place;
    if ((crossed_x | crossed_y) != 0) [[unlikely]] {
      disks_.identities[row].image_x += crossed_x;
      disks_.identities[row].image_y += crossed_y;
    }
    double const drift = squared_length(box_.displacement_inside(disks_.motions[row].listed_at, place));
    ways_.squared_drift = std::max(ways_.squared_drift, drift);
  }
  [[nodiscard]] LongestWays const& ways() const { return ways_; }

 private:
  Box const box_;
  Disks& disks_;
  LongestWays ways_;
};

LongestWays move_by_inertia(MoveRule const& rule, Band const& band, Disks& disks) {
  Mover mover(rule.box, disks);
  for (std::size_t row = band.first; row < band.end; ++row) {
    Motion& motion = disks.motions[row];
    motion.velocity = motion.velocity + motion.kick * motion.force;
    mover.put(row, rule.duration * motion.velocity);
  }
  return mover.ways();
}

LongestWays move_in_bath(MoveRule const& rule, std::uint64_t step, Band const& band, Disks& disks) {
  Mover mover(rule.box, disks);
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
  Mover mover(rule.box, disks);
  HeadingStep const of_step = rule.heading.is_on() ? heading_step(rule.heading, step) : HeadingStep{};
  with_noise(rule, step, band, disks, [&](std::size_t row, Vector noise) {
    Motion& motion = disks.motions[row];
    if (rule.heading.is_on()) {
      motion.velocity = turned_velocity(of_step, disks.identities[row].id_index, motion.velocity);
    }
    mover.put(row, rule.duration * motion.velocity + motion.kick * motion.force + motion.noise * noise);
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
          .heading = heading_rule(settings.propulsion, duration, state.seed)};
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
