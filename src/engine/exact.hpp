#pragma once

#include <cstdint>
#include <memory>

#include "engine/exact/left_state.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

class ThreadPool;

namespace exact {
class Dynamics;
}

EngineRecord exact_record();

/// Throws Error for a state that the exact dynamics cannot start from, see ExactEngine.
void require_exact_start(State const& state);

/// The length that the sides of a periodic box must exceed, so that no disk can touch another from both sides at once.
double side_for_images(State const& state);

/// Hard disks without a time step: from collision to collision, the dynamics every stepped result is judged against.
///
/// The disks fly freely between events; docs/explanation/exact.md explains how the events are found. Between two calls
/// of advance() the engine keeps its own state as long as the caller leaves the disks alone, so that the same run has
/// the same bits however it is cut into calls; positions handed out are those at state.clock.time, or after a collision
/// asked for those at its exact time, which the clock holds with fewer digits.
/// Errors: Error for a state that validate() refuses with a tolerance for rounding, for a periodic box in which two
/// disks could touch on both sides at once, and for a disk that moves between two walls it touches. RunFailure where
/// collisions without end keep the time from passing.
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

  /// How many audits there have been since the start of the run, all of which found nothing.
  [[nodiscard]] std::uint64_t made_audits() const;
  /// Those of them that looked for missed events, not for overlaps alone.
  [[nodiscard]] std::uint64_t audits_for_missed_events() const;

 private:
  [[nodiscard]] bool is_as_left(State const& state) const;
  void start_from(State const& state);
  void make_dynamics(State const& state);
  [[nodiscard]] double next_target(Clock const& clock, StopCondition const& stop_condition) const;
  bool pass_steps_until(double time, Clock& clock);
  /// Up to date at the last event handled, the clock no later than `latest`.
  void leave_at_last_event(State& state, double latest);

  std::uint64_t audit_every_;
  std::uint64_t earlier_audits_ = 0;  // of dynamics that are gone
  double duration_;
  std::uint64_t thread_count_;
  std::unique_ptr<ThreadPool> threads_;        // nullptr while there are too few disks to share
  std::unique_ptr<exact::Dynamics> dynamics_;  // nullptr until the first advance()
  exact::LeftState left_;
  double start_time_ = 0.0;
  double next_step_time_ = 0.0;
};

}  // namespace gridlock
