#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "engine/exact/kicked_disks.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/counters.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/propulsion.hpp"
#include "gridlock/engine/thermostat.hpp"

namespace gridlock::exact {

class Dynamics;

/// The kicks of a thermostat: when the next one is due, and what velocities it gives. Fixed disks get none, and have no
/// id index.
///
/// Times are those of the clock. A kick is due at its time, however the run is cut into calls.
class Thermostat {
 public:
  /// Contract: resolved settings.
  Thermostat(ThermostatSettings const& settings, PropulsionSettings const& propulsion, std::uint64_t seed)
      : settings_(settings), propulsion_(propulsion), seed_(seed) {}

  [[nodiscard]] bool is_brownian() const { return settings_.kind == ThermostatKind::brownian; }
  /// The time of the next kick; infinity where there is none.
  [[nodiscard]] double next_time() const;

  /// Plans the kicks after the clock of a state, and gives it the one that is due now.
  void start_from(State& state);
  /// Gives the kick of next_time() to a dynamics whose time began at `start_time`; counts how far disks have swum.
  void kick(Dynamics& dynamics, double start_time, Counters& counters);

  /// The headings of self-propelled disks by id index; empty for others, and before start_from().
  [[nodiscard]] std::span<Vector const> headings() const { return headings_; }

  /// Contract: the state has the disks that the kicks are planned for.
  void serialize(Archive& archive, State const& state);

 private:
  /// The next kick of a disk of `andersen`.
  struct KickOfDisk {
    double time;
    std::uint32_t id_index;

    /// For a heap whose first element comes first in time.
    friend bool operator<(KickOfDisk const& a, KickOfDisk const& b) {
      return a.time != b.time ? a.time > b.time : a.id_index > b.id_index;
    }
  };

  [[nodiscard]] double time_of(std::uint64_t kick) const {
    return static_cast<double>(kick) * settings_.interval.value_or(0.0);
  }
  [[nodiscard]] RandomStream draws(std::uint64_t kick, Id id) const { return {seed_, kick, id, Purpose::thermostat}; }
  [[nodiscard]] Vector velocity(RandomStream& random, double mass) const;
  void draw_velocities(std::uint64_t kick, KickedDisks const& disks, std::span<Vector> velocities) const;
  void begin_swimming(State const& state, std::span<std::uint32_t const> rows);
  void turn_headings(Dynamics const& dynamics, std::uint64_t kick, double elapsed, Counters& counters);
  void serialize_swimming(Archive& archive, std::size_t disks);
  void plan_kick(std::uint32_t id_index, Id id, double time);

  ThermostatSettings settings_;
  PropulsionSettings propulsion_;
  std::uint64_t seed_;
  std::uint64_t next_kick_ = 0;             ///< of brownian
  std::vector<KickOfDisk> kicks_;           ///< of andersen, a heap
  std::vector<std::uint64_t> kick_counts_;  ///< of andersen, by id index: the number of the draw of the next kick
  std::vector<Vector> headings_;            ///< of self-propelled disks, by id index
  std::vector<Vector> places_;              ///< where they were at the last kick, by id index
  bool is_flight_whole_ = false;            ///< whether a kick began their present flight
};

}  // namespace gridlock::exact
