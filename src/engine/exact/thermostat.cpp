#include "engine/exact/thermostat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/exact/dynamics.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"

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

Vector Thermostat::velocity_of(std::uint64_t kick, Id id, double mass) const {
  RandomStream random = draws(kick, id);
  return velocity(random, mass);
}

void Thermostat::start_from(State& state) {
  Disks& disks = state.agents;
  if (is_brownian()) {
    next_kick_ = static_cast<std::uint64_t>(std::max(0.0, std::ceil(state.clock.time / *settings_.interval)));
    while (time_of(next_kick_) < state.clock.time) ++next_kick_;
    if (time_of(next_kick_) > state.clock.time) return;
    for (std::size_t row = 0; row < disks.size(); ++row) {
      Vector const v = velocity_of(next_kick_, disks.ids()[row], disks.column<Mass>()[row]);
      disks.column<VelocityX>()[row] = v.x;
      disks.column<VelocityY>()[row] = v.y;
    }
    ++next_kick_;
    return;
  }
  kicks_.clear();
  // Draws of a run that goes on with other disks are not those from its start.
  kick_counts_.assign(disks.size(), state.clock.step << 32U);
  std::vector<std::uint32_t> const rows = rows_in_order(disks.ids());
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

void Thermostat::kick(Dynamics& dynamics, double start_time) {
  if (is_brownian()) {
    std::uint64_t const kick = next_kick_++;
    dynamics.kick_all(time_of(kick) - start_time, time_of(next_kick_) - start_time,
                      [&](Id id, double mass) { return velocity_of(kick, id, mass); });
    return;
  }
  std::pop_heap(kicks_.begin(), kicks_.end());
  KickOfDisk const due = kicks_.back();
  kicks_.pop_back();
  Id const id = dynamics.kick(due.time - start_time, due.id_index, [&](Id of_disk, double mass) {
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
  std::size_t const disks = is_brownian() ? 0 : state.agents.size();
  archive.visit("next_kick", next_kick_);
  archive.visit("kick_times", times);
  archive.visit("kick_counts", kick_counts_);
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

}  // namespace gridlock::exact
