#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/disks_overview.hpp"
#include "engine/tiled/on_ranks.hpp"
#include "grid/validate_rows.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/detail/agents_of_rank.hpp"
#include "simulation/start_on_ranks.hpp"

namespace gridlock {

/// What one of several ranks has of a run of disks: some rows of the state, in the order of the Ids. Nobody has all
/// rows.
class DisksOfRank final : public AgentsOfRank {
 public:
  /// All call it. The disks are those of a start that each rank makes by itself, or some that the leader has, all of
  /// them or their file.
  /// Errors: Error, on all ranks, where the settings or a row cannot be.
  DisksOfRank(Communicator& ranks, Configuration const& configuration, State const* whole = nullptr,
              StartFile const* file = nullptr);

  /// For the checks of a set-up.
  [[nodiscard]] DisksOverview const& all() const { return all_; }

  /// Makes the engine of the leader, which is patient where only collisions end the run. Errors: Error where disks
  /// overlap.
  void begin(EngineSettings const& settings, RunSettings const& run);

  [[nodiscard]] Box const& box() const override { return own_.box; }
  [[nodiscard]] Clock const& clock() const override { return own_.clock; }
  void set_clock(Clock const& clock) override { own_.clock = clock; }
  [[nodiscard]] std::uint64_t seed() const override { return own_.seed; }
  [[nodiscard]] AgentsView view() const override { return own_.agents; }
  [[nodiscard]] std::vector<NamedColumn> columns() override { return columns_of(own_.agents); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return own_.agents.release(); }
  [[nodiscard]] Snapshot snapshot(Counters const& counters, Communicator& processes) const override {
    return {own_, counters, processes, count()};
  }
  [[nodiscard]] std::uint64_t sum_of_hashes() const override { return gridlock::sum_of_hashes(own_.agents); }
  [[nodiscard]] std::size_t count() const override { return all_.count; }
  [[nodiscard]] RowDivision const* rows() const override { return &rows_; }
  [[nodiscard]] std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings,
                                                                          Snapshot const& start) const override {
    return gridlock::make_observables(settings, start);
  }
  void serialize(Archive& archive) override;
  [[nodiscard]] ArrangedAgents arranged() const override { return {.rows = rows_, .own = own_.agents, .memory = {}}; }
  bool carry_out(TaskOfRanks task, MessageReader& message) override;
  void advance(Counters& counters, StopCondition const& stop_condition) override {
    engine_->advance(own_, counters, stop_condition);
  }
  [[nodiscard]] double time_step() const override { return engine_->time_step_of(own_); }
  [[nodiscard]] std::vector<Count> event_counts(Counters const& counters) const override {
    return engine_->counts(own_, counters);
  }
  void require_valid() const override { tiled_->require_no_overlaps(own_); }

 private:
  void make_rows(Configuration const& configuration);
  void read_rows(Configuration const& configuration, StartFile const* file);
  void draw_velocities(Configuration const& configuration);
  void receive_rows();
  void hand_out(State const& whole);
  [[nodiscard]] RowProblems problems_of_rows() const;
  /// patience_for() all disks. All ranks call it.
  [[nodiscard]] double patience() const;

  Communicator& ranks_;
  RowDivision rows_;
  State own_;
  DisksOverview all_;
  TiledOnRanks* tiled_ = nullptr;  ///< the engine of the leader, which another one may watch
  std::unique_ptr<EngineFor<HardDisks>> engine_;
};

}  // namespace gridlock
