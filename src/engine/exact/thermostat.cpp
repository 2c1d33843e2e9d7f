#include "engine/exact/thermostat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/normal_pairs.hpp"
#include "core/unwrapped.hpp"
#include "engine/exact/dynamics.hpp"
#include "engine/exact/moving_rows.hpp"
#include "engine/headings.hpp"
#include "gridlock/core/detail/exact_sum.hpp"

namespace gridlock::exact {

double Thermostat::next_time() const {
  if (is_brownian()) return time_of(next_kick_);
  return kicks_.empty() ? std::numeric_limits<double>::infinity() : kicks_.front().time;
}

Vector Thermostat::velocity(RandomStream& random, double mass) const {
  double const width = std::sqrt(*settings_.temperature / mass);
  double const x = random.normal();
  return {width * x, width * random.normal()};
}

void Thermostat::draw_velocities(std::uint64_t kick, KickedDisks const& disks, std::span<Vector> velocities) const {
  draw_normal_pairs(seed_, kick, disks.ids, Purpose::thermostat, velocities);
  double mass = 0.0;
  double width = 0.0;
  for (std::size_t k = 0; k < velocities.size(); ++k) {
    if (disks.masses[k] != mass) {
      mass = disks.masses[k];
      width = std::sqrt(*settings_.temperature / mass);
    }
    velocities[k] = width * velocities[k];
    if (!headings_.empty()) velocities[k] = velocities[k] + propulsion_.speed * headings_[disks.id_indices[k]];
  }
}

/// Takes headings from the velocities.
void Thermostat::begin_swimming(State const& state, std::span<std::uint32_t const> rows) {
  Disks const& disks = state.agents;
  headings_.clear();
  places_.clear();
  if (!propulsion_.is_on()) return;
  for (std::uint32_t const row : rows) {
    headings_.push_back(first_heading(state.seed, disks.ids()[row], gridlock::velocity(disks, row)));
    Vector const crossed{static_cast<double>(disks.column<ImageX>()[row]),
                         static_cast<double>(disks.column<ImageY>()[row])};
    places_.push_back(unwrapped_displacement(state.box, {}, position(disks, row), crossed));
  }
}

/// Adds up how far the disks have swum in the flight that ends at a kick, and turns their headings.
void Thermostat::turn_headings(Dynamics const& dynamics, std::uint64_t kick, double elapsed, Counters& counters) {
  double const width = turn_width(propulsion_, *settings_.interval);
  ExactSum way;
  dynamics.visit_disks(elapsed, [&](Id id, std::uint32_t id_index, Vector place) {
    Vector& heading = headings_[id_index];
    way.add(dot(place - places_[id_index], heading));
    places_[id_index] = place;
    RandomStream random(seed_, kick, id, Purpose::heading);
    Vector const turned = rotated(heading, direction(width * random.normal()));
    heading = (1.5 - 0.5 * squared_length(turned)) * turned;
  });
  if (is_flight_whole_) {
    counters.swum += way.value() / (propulsion_.speed * *settings_.interval);
    counters.swum_if_free += static_cast<double>(headings_.size());
  }
  is_flight_whole_ = true;
}

void Thermostat::start_from(State& state) {
  Disks& disks = state.agents;
  std::vector<std::uint32_t> const rows = moving_rows(disks);
  if (is_brownian()) {
    next_kick_ = static_cast<std::uint64_t>(std::max(0.0, std::ceil(state.clock.time / *settings_.interval)));
    while (time_of(next_kick_) < state.clock.time) ++next_kick_;
    begin_swimming(state, rows);
    is_flight_whole_ = time_of(next_kick_) == state.clock.time;
    if (!is_flight_whole_) return;
    for (std::uint32_t id_index = 0; id_index < rows.size(); ++id_index) {
      std::uint32_t const row = rows[id_index];
      Vector v;
      draw_velocities(next_kick_, {{&disks.ids()[row], 1}, {&id_index, 1}, {&disks.column<Mass>()[row], 1}}, {&v, 1});
      disks.column<VelocityX>()[row] = v.x;
      disks.column<VelocityY>()[row] = v.y;
    }
    ++next_kick_;
    return;
  }
  kicks_.clear();
  // Draws of a run that goes on with other disks are not those from its start.
  kick_counts_.assign(rows.size(), state.clock.step << 32U);
  for (std::uint32_t id_index = 0; id_index < rows.size(); ++id_index) {
    plan_kick(id_index, disks.ids()[rows[id_index]], state.clock.time);
  }
}

/// Plans the kick of a disk after the one at `time`. Waiting times are exponential, so that it does not matter when the
/// last kick was.
void Thermostat::plan_kick(std::uint32_t id_index, Id id, double time) {
  RandomStream random = draws(kick_counts_[id_index], id);
  kicks_.push_back({.time = time + random.exponential() / *settings_.rate, .id_index = id_index});
  std::push_heap(kicks_.begin(), kicks_.end());
}

void Thermostat::kick(Dynamics& dynamics, double start_time, Counters& counters) {
  if (is_brownian()) {
    std::uint64_t const kick = next_kick_++;
    double const elapsed = time_of(kick) - start_time;
    if (propulsion_.is_on()) turn_headings(dynamics, kick, elapsed, counters);
    dynamics.kick_all(
        elapsed, time_of(next_kick_) - start_time,
        [&](KickedDisks const& disks, std::span<Vector> velocities) { draw_velocities(kick, disks, velocities); });
    return;
  }
  std::pop_heap(kicks_.begin(), kicks_.end());
  KickOfDisk const due = kicks_.back();
  kicks_.pop_back();
  Id const id =
      dynamics.kick(due.time - start_time, due.id_index, [&](Id of_disk, std::uint32_t /*id_index*/, double mass) {
        RandomStream random = draws(kick_counts_[due.id_index], of_disk);
        static_cast<void>(random.exponential());  // the waiting time, which was drawn before
        return velocity(random, mass);
      });
  ++kick_counts_[due.id_index];
  plan_kick(due.id_index, id, due.time);
}

void Thermostat::serialize(Archive& archive, State const& state) {
  std::vector<double> times(kick_counts_.size());
  for (KickOfDisk const& kick : kicks_) times[kick.id_index] = kick.time;
  std::size_t const moving = state.agents.size() - count_of_fixed(state.agents);
  std::size_t const disks = is_brownian() ? 0 : moving;
  archive.visit("next_kick", next_kick_);
  archive.visit("kick_times", times);
  archive.visit("kick_counts", kick_counts_);
  if (propulsion_.is_on()) serialize_swimming(archive, moving);
  if (!archive.is_restoring()) return;
  archive.require(times.size() == disks && kick_counts_.size() == disks,
                  "the thermostat has other disks than the state");
  kicks_.clear();
  for (std::uint32_t id_index = 0; id_index < disks; ++id_index) {
    archive.require(times[id_index] >= 0.0 && std::isfinite(times[id_index]), "a kick has no time");
    kicks_.push_back({.time = times[id_index], .id_index = id_index});
  }
  std::make_heap(kicks_.begin(), kicks_.end());
}

void Thermostat::serialize_swimming(Archive& archive, std::size_t disks) {
  archive.visit("is_flight_whole", is_flight_whole_);
  auto const visit = [&](char const* name, std::vector<Vector>& vectors) {
    std::vector<double> numbers;
    for (Vector const v : vectors) numbers.insert(numbers.end(), {v.x, v.y});
    archive.visit(name, numbers);
    archive.require(numbers.size() == 2 * disks, "the headings are those of other disks than the state has");
    vectors.resize(disks);
    for (std::size_t k = 0; k < disks; ++k) vectors[k] = {numbers[2 * k], numbers[2 * k + 1]};
  };
  visit("headings", headings_);
  visit("places", places_);
  for (std::size_t k = 0; k < disks; ++k) {
    archive.require(std::abs(squared_length(headings_[k]) - 1.0) < 1e-9, "a heading has not the length 1");
    archive.require(std::isfinite(places_[k].x) && std::isfinite(places_[k].y), "a disk has no place");
  }
}

}  // namespace gridlock::exact
