#pragma once

#include "engine/heading_columns.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

EngineRecord soft_record();

/// The engine `soft`: disks with a potential that move by Newton's equations, in a Langevin bath, or without inertia;
/// docs/explanation/soft_disks.md has the formulas.
///
/// Between two calls it keeps nothing: forces are a function of the places, and noise of the seed, the step and the Id.
/// A run has the same bits for any number of threads, however it is divided into calls.
/// Errors: Error for a box with walls or too small for the cutoff, for a state that validate() refuses for another
/// reason than overlaps, and for disks of an unbounded potential that overlap much. RunFailure for a time step that is
/// too long: a disk moves more than half a diameter in it, two disks come too near, or the energy of Newton's equations
/// changes. The state is then that of the last call.
/// Cost: docs/reference/performance.md.
class SoftEngine final : public Engine {
 public:
  SoftEngine(EngineSettings const& settings, State const& state);

  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step() const override { return duration_; }
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override;
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override {
    give_frame_with_headings(settings_.propulsion, of_world, use);
  }
  void require_valid(State const& state) const override;

  /// Changes how far beyond the cutoff lists reach, in smallest diameters; this changes no bits.
  void set_skin(double skin) { skin_ = skin; }

 private:
  EngineSettings settings_;
  double duration_;
  double skin_ = 0.0;  ///< 0: the usual one
  ThreadPool pool_;
};

}  // namespace gridlock
