#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/exact/left_state.hpp"
#include "engine/exact/thermostat.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

class ThreadPool;

namespace exact {
class Dynamics;
}

EngineRecord exact_record();

/// Throws Error for a state from which the exact dynamics cannot start; ExactEngine lists the reasons.
void require_exact_start(State const& state);

/// The length that both sides of a periodic box must exceed, so that no disk touches another from two sides at once.
double side_for_images(State const& state);

/// The engine `exact`: hard disks from collision to collision, without a time step. Stepped engines are judged against
/// it.
///
/// Disks fly freely between events; docs/explanation/exact.md explains how the events are found. Between two calls of
/// advance() the engine keeps its own state as long as the caller leaves the disks alone, so that a run has the same
/// bits however it is divided into calls. Positions are written for the time state.clock.time. After a stop at a
/// collision they are those at the exact time of the collision, which the clock holds with fewer digits.
/// Errors: Error for a state that validate() refuses with a tolerance for rounding, for a periodic box in which two
/// disks could touch on both sides at once, and for a disk that moves between two walls it touches. RunFailure where
/// collisions without end keep the time from passing.
/// A thermostat gives disks new velocities at times that do not depend on the calls either.
/// Cost: O(1) per collision. Threads share the work of many disks; any number of them gives the same bits.
class ExactEngine final : public Engine {
 public:
  ExactEngine(EngineSettings const& settings, State const& state);
  ~ExactEngine() override;

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  void require_valid(State const& state) const override;
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override;
  [[nodiscard]] std::vector<Count> audits() const override;
  void serialize(Archive& archive, State const& state) override;
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override;
  void report_collisions(ReportCollision report) override;

  /// The number of audits since the start of the run; an audit that finds a fault ends the run.
  [[nodiscard]] std::uint64_t made_audits() const;
  /// The number of audits that looked for missed events, not only for overlaps.
  [[nodiscard]] std::uint64_t audits_for_missed_events() const;
  /// The number of collisions that lost nothing because of CollisionSettings::contact_time.
  [[nodiscard]] std::uint64_t elastic_contacts() const;

 private:
  [[nodiscard]] bool is_as_left(State const& state) const;
  void start_from(State& state);
  void make_dynamics(State const& state);
  [[nodiscard]] double next_target(Clock const& clock, StopCondition const& stop_condition) const;
  bool pass_steps_until(double time, Clock& clock);
  [[nodiscard]] double next_kick_time() const;
  void expect_kick();
  void ask_for_reports();
  /// Writes the state at the last event handled; the clock is set no later than `latest`.
  void leave_at_last_event(State& state, double latest);

  std::uint64_t audit_every_;
  std::uint64_t earlier_audits_ = 0;  // audits of dynamics that have been replaced
  double duration_;
  std::uint64_t thread_count_;
  ThermostatSettings thermostat_settings_;  // resolved
  CollisionSettings collisions_;
  Vector gravity_;
  std::vector<WallSettings> walls_;
  PropulsionSettings propulsion_;
  std::uint64_t earlier_contacts_ = 0;         // elastic contacts of dynamics that have been replaced
  ReportCollision report_;                     // empty where nobody asks for collisions
  std::unique_ptr<ThreadPool> threads_;        // nullptr while there are too few disks for threads
  std::unique_ptr<exact::Dynamics> dynamics_;  // nullptr until the first advance()
  std::optional<exact::Thermostat> thermostat_;
  exact::LeftState left_;
  double start_time_ = 0.0;
  double next_step_time_ = 0.0;
};

}  // namespace gridlock
