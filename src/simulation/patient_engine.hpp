#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// Returns the time after which a run that only collisions can end fails without a collision, in physical time.
///
/// In a gas of N disks of the smallest size, a disk of typical speed v collides after about t = A / (N σ v). The result
/// is 10⁴ t for many disks, and 10⁶ t for two disks, which may miss each other for long; either is beyond chance, yet
/// takes little computing time. In a periodic box velocities are relative to their mean, since disks that move alike
/// never meet. `own` are the disks of this process.
double patience_for(State const& own, AllProcesses processes = {});

/// An engine for runs that only collisions can end. It throws if none occur for a long time.
///
/// The waiting time is not serialized. A resumed run starts to wait anew, which affects only runs that will fail.
class PatientEngine final : public EngineFor<HardDisks> {
 public:
  PatientEngine(std::unique_ptr<EngineFor<HardDisks>> engine, double patience, AllProcesses processes = {})
      : engine_(std::move(engine)), patience_(patience), processes_(processes) {}

  /// Errors: RunFailure also if no collision occurs within the time `patience`.
  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step_of(State const& state) const override { return engine_->time_step_of(state); }
  void require_valid(State const& state) const override { engine_->require_valid(state); }
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override {
    return engine_->counts(state, counters);
  }
  [[nodiscard]] std::vector<Count> audits() const override { return engine_->audits(); }
  void take_restored(State& state) override { engine_->take_restored(state); }
  void serialize(Archive& archive, State const& state) override { engine_->serialize(archive, state); }
  void report_collisions(ReportCollision report) override { engine_->report_collisions(std::move(report)); }
  void give_frame(FrameSource const& of_world, UseFrame const& use) const override {
    engine_->give_frame(of_world, use);
  }

 private:
  std::unique_ptr<EngineFor<HardDisks>> engine_;
  double patience_;
  AllProcesses processes_;
  std::optional<double> last_collision_;  ///< time at which the count last increased
  std::uint64_t collisions_seen_ = 0;
};

}  // namespace gridlock
