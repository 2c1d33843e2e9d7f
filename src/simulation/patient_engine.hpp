#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// How long a run that only collisions can end waits for the next one before it gives up, in physical time.
///
/// In a gas of as many disks of the smallest size, a disk of the typical speed v meets another after about
/// t = A / (N σ v). Ten thousand times that is far beyond chance for many disks and a million times for two, which pass
/// each other now and then for long; yet it is soon over in a computer. Velocities count from their mean in a periodic
/// box, where disks that all move alike never meet.
/// `own` are the disks of this process, of all that share them.
double patience_for(State const& own, AllProcesses processes = {});

/// An engine for runs that only collisions can end: it gives up where none come.
///
/// How long it has waited is not serialized: a run that is resumed waits anew, and only one that fails depends on it.
class PatientEngine final : public EngineFor<HardDisks> {
 public:
  PatientEngine(std::unique_ptr<EngineFor<HardDisks>> engine, double patience, AllProcesses processes = {})
      : engine_(std::move(engine)), patience_(patience), processes_(processes) {}

  /// Errors: RunFailure also where no collision comes for that long.
  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step_of(State const& state) const override { return engine_->time_step_of(state); }
  void require_valid(State const& state) const override { engine_->require_valid(state); }
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override {
    return engine_->counts(state, counters);
  }
  [[nodiscard]] std::vector<Count> audits() const override { return engine_->audits(); }
  void take_restored(State& state) override { engine_->take_restored(state); }
  void serialize(Archive& archive, State const& state) override { engine_->serialize(archive, state); }

 private:
  std::unique_ptr<EngineFor<HardDisks>> engine_;
  double patience_;
  AllProcesses processes_;
  std::optional<double> last_collision_;  ///< when one was last seen
  std::uint64_t collisions_seen_ = 0;
};

}  // namespace gridlock
