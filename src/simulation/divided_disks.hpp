#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/disks_overview.hpp"
#include "core/row_division.hpp"
#include "engine/tiled/on_ranks.hpp"
#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/observe/detail/observable_set.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/simulation.hpp"
#include "io/checkpoint.hpp"
#include "observe/agents_on_ranks.hpp"

namespace gridlock {

/// What one of several ranks has of a run of disks: some rows of the state, in the order of the Ids, and what is measured of them
/// together with those of the others. Nobody has all rows.
class DisksOfRank {
 public:
  /// All call it. The disks are those of a start that each rank makes by itself, or some that the leader has and hands out.
  /// Errors: Error, on all ranks, where the settings or a row cannot be.
  DisksOfRank(Ranks& ranks, Configuration const& configuration, State const* whole);

  [[nodiscard]] Ranks& ranks() const { return ranks_; }
  [[nodiscard]] RowDivision const& rows() const { return rows_; }
  [[nodiscard]] DisksOverview const& all() const { return all_; }
  [[nodiscard]] State& own() { return own_; }
  [[nodiscard]] State const& own() const { return own_; }
  [[nodiscard]] Counters& counters() { return counters_; }
  [[nodiscard]] Counters const& counters() const { return counters_; }
  [[nodiscard]] ObservableSet const& observables() const { return observables_; }

  // Of the following, too, all ranks call each.

  /// Begins to measure.
  void observe(ObserveSettings const& settings);
  void sample(std::span<double> row, bool counts_for_average);
  /// The hash of all disks, for the leader.
  [[nodiscard]] std::uint64_t state_hash() const;
  /// patience_for() all disks.
  [[nodiscard]] double patience() const;
  /// Writes the rows of this rank into the directory of a run. Returns the parts of all, for the leader. Errors: RunFailure, on the leader.
  [[nodiscard]] std::vector<CheckpointPart> write_part(std::filesystem::path const& directory,
                                                       SerializeAll const& serialize) const;
  /// Errors: Error, on all ranks.
  std::optional<Restored> restore(std::filesystem::path const& directory, SerializeAll const& serialize);

  /// What a WorldSimulation serializes; of the agents the own rows.
  void serialize(Archive& archive);

 private:
  void receive_rows();
  void hand_out(State const& whole);
  [[nodiscard]] CheckpointShare share() const;
  /// Does some work on all ranks. Errors: Error on all of them where there is one on any, that of the first.
  void agreed(std::function<void()> const& work) const;
  [[nodiscard]] std::string first_of_all(std::string const& text) const;

  Ranks& ranks_;
  RowDivision rows_;
  State own_;
  DisksOverview all_;
  Counters counters_;
  std::unique_ptr<OtherAgents> others_;
  ObservableSet observables_;
};

/// A run of disks whose rows are divided among ranks, of which this one leads. view() and the columns to be changed are those of
/// its own rows. The bits are those of one process.
class DividedDisks final : public Simulation {
 public:
  /// Sets up the disks on all ranks; `whole` has them where they are no function of the settings and the row, and can go afterwards.
  /// Errors: Error.
  DividedDisks(Ranks& ranks, Configuration const& configuration, std::optional<State> whole);
  DividedDisks(DividedDisks const&) = delete;
  DividedDisks& operator=(DividedDisks const&) = delete;
  ~DividedDisks() override;

  /// For the checks of a set-up.
  [[nodiscard]] DisksOverview const& all() const { return disks_.all(); }

  /// Makes the engine, which is patient where only collisions end the run, and begins to measure. Errors: Error where disks overlap.
  void begin(EngineSettings const& settings, RunSettings const& run, ObserveSettings const& observe);

  [[nodiscard]] Clock clock() const override { return disks_.own().clock; }
  [[nodiscard]] double time_step() const override { return engine_->time_step_of(disks_.own()); }
  [[nodiscard]] Box const& box() const override { return disks_.own().box; }
  [[nodiscard]] AgentsView view() const override { return disks_.own().agents; }
  [[nodiscard]] std::size_t agents() const override { return disks_.all().count; }
  [[nodiscard]] std::uint64_t state_hash() const override;
  [[nodiscard]] std::vector<Count> counts() const override { return engine_->counts(disks_.own(), disks_.counters()); }
  [[nodiscard]] std::uint64_t pair_collisions() const override { return disks_.counters().pair_collisions; }
  [[nodiscard]] std::vector<NamedColumn> columns_of_agents() override { return columns_of(disks_.own().agents); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return disks_.own().agents.release(); }
  void require_valid() const override;
  void advance(StopCondition const& stop_condition) override;
  void observe(std::unique_ptr<Observable> observable) override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return disks_.observables().columns(); }
  void sample(std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return disks_.observables().results(); }
  [[nodiscard]] std::vector<Distribution> distributions() const override {
    return disks_.observables().distributions();
  }
  [[nodiscard]] std::unique_ptr<FrameSource> frame_source() const override;
  void serialize(Archive& archive) override { disks_.serialize(archive); }

  /// Every rank writes its rows; the checkpoint that names them comes next. `serialize` visits the whole run, this simulation inside.
  /// Errors: RunFailure.
  [[nodiscard]] std::vector<CheckpointPart> write_parts(std::filesystem::path const& directory,
                                                        SerializeAll const& serialize);
  /// Restores the newest checkpoint that is whole on all ranks. Errors: Error.
  std::optional<Restored> restore(std::filesystem::path const& directory, SerializeAll const& serialize);

 private:
  class Source;
  void send(TaskOfRanks task) const;

  Ranks& ranks_;
  DisksOfRank disks_;
  TiledOnRanks* tiled_ = nullptr;  ///< the engine, which another one may watch
  std::unique_ptr<EngineFor<HardDisks>> engine_;
};

/// What every other rank does for a DividedDisks of the leader.
class DisksHelper {
 public:
  explicit DisksHelper(Ranks& ranks) : ranks_(ranks) {}

  /// Whether the task was one of this kind.
  bool carry_out(TaskOfRanks task, MessageReader& message);

 private:
  void give_rows(MessageReader& message) const;

  Ranks& ranks_;
  Configuration configuration_;
  std::optional<DisksOfRank> disks_;
};

}  // namespace gridlock
