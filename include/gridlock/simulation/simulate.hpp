#pragma once

#include <memory>
#include <optional>

#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/run.hpp"

namespace gridlock {

/// The disks of a set-up, the engine that moves them and the observables: the simulation behind simulate().
class DiskSimulation final : public Simulation {
 public:
  /// Errors: those of make_engine().
  explicit DiskSimulation(Setup&& setup);

  [[nodiscard]] State const& state() const { return state_; }
  [[nodiscard]] Counters const& counters() const { return counters_; }

  [[nodiscard]] Clock clock() const override { return state_.clock; }
  [[nodiscard]] double time_step() const override { return engine_->time_step(); }
  [[nodiscard]] std::size_t agents() const override { return state_.disks.size(); }
  [[nodiscard]] std::uint64_t state_hash() const override { return hash(state_); }
  [[nodiscard]] std::vector<Count> counts() const override;
  [[nodiscard]] std::uint64_t pair_collisions() const override { return counters_.pair_collisions; }
  /// Errors: RunFailure also where the run ends only after some number of collisions and no more of them come.
  void advance(StopCondition const& stop_condition) override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override;
  void sample(std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override;
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  [[nodiscard]] Frame frame() const override { return frame_of(state_); }
  void serialize(Archive& archive) override;

 private:
  EngineSettings engine_settings_;
  State state_;
  Counters counters_;
  std::unique_ptr<Engine> engine_;
  std::vector<std::unique_ptr<Observable>> observables_;

  /// How long the run waits for the next collision; for ever where it ends without.
  double patience_;
  /// When a collision was last seen. Not serialized: a run that is resumed waits anew, and only one that fails depends
  /// on it.
  std::optional<double> last_collision_;
  std::uint64_t collisions_seen_ = 0;
};

/// The simulation a set-up describes. Takes the state out of it; the settings stay. Errors: those of its constructor.
std::unique_ptr<Simulation> make_simulation(Setup&& setup);

/// How far a set-up is carried on, and what is looked at on the way.
RunPlan plan_of(Setup const& setup);

/// What a run of disks leaves behind.
struct RunResult : RunRecord {
  State state;
  Counters counters;
};

/// Runs a set-up to its end, sampling every observe.every steps and at the end.
///
/// The bits of state and series do not depend on how often progress is reported.
/// Errors: none for a run that breaks: it ends as RunStatus::failed with what there is.
RunResult simulate(Setup setup, OnProgress const& on_progress = {});

}  // namespace gridlock
