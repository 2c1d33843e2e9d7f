#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/disks_overview.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// How long a run that only collisions can end waits for the next one before it gives up, in physical time.
///
/// In a gas of as many disks of the smallest size, a disk of the typical speed v meets another after about
/// t = A / (N σ v). Ten thousand times that is far beyond chance for many disks and a million times for two, which pass
/// each other now and then for long; yet it is soon over in a computer. Velocities count from their mean in a periodic
/// box, where disks that all move alike never meet.
double patience_for(State const& state);

/// Σ v, and Σ (v − mean)².
struct SpeedSums {
  Vector velocity;
  double squares = 0.0;
};
/// The same of some of all disks. `add_all(add)` has add(sums) add what each process has, row after row of all.
double patience_for(State const& some, DisksOverview const& all,
                    std::function<SpeedSums(std::function<void(SpeedSums&)> const& add)> const& add_all);

/// An engine for runs that only collisions can end: it gives up where none come.
///
/// How long it has waited is not serialized: a run that is resumed waits anew, and only one that fails depends on it.
class PatientEngine final : public EngineFor<HardDisks> {
 public:
  PatientEngine(std::unique_ptr<EngineFor<HardDisks>> engine, double patience)
      : engine_(std::move(engine)), patience_(patience) {}

  /// Errors: RunFailure also where no collision comes for that long.
  void advance(State& state, Counters& counters, StopCondition const& stop_condition) override;
  [[nodiscard]] double time_step_of(State const& state) const override { return engine_->time_step_of(state); }
  void require_valid(State const& state) const override { engine_->require_valid(state); }
  [[nodiscard]] std::vector<Count> counts(State const& state, Counters const& counters) const override {
    return engine_->counts(state, counters);
  }
  [[nodiscard]] std::vector<Count> audits() const override { return engine_->audits(); }
  void serialize(Archive& archive, State const& state) override { engine_->serialize(archive, state); }

 private:
  std::unique_ptr<EngineFor<HardDisks>> engine_;
  double patience_;
  std::optional<double> last_collision_;  ///< when one was last seen
  std::uint64_t collisions_seen_ = 0;
};

}  // namespace gridlock
