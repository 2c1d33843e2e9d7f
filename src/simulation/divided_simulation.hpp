#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/observe/detail/observable_set.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/tasks.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/detail/agents_of_rank.hpp"
#include "gridlock/simulation/simulation.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {

/// What one of several ranks has of a run whose agents are divided among them: its agents, and what is measured of them
/// together with those of the others.
class RunOfRank {
 public:
  RunOfRank(Communicator& ranks, std::unique_ptr<AgentsOfRank> agents) : ranks_(ranks), agents_(std::move(agents)) {}

  [[nodiscard]] AgentsOfRank& agents() { return *agents_; }
  [[nodiscard]] AgentsOfRank const& agents() const { return *agents_; }
  [[nodiscard]] Counters& counters() { return counters_; }
  [[nodiscard]] Counters const& counters() const { return counters_; }
  [[nodiscard]] ObservableSet const& observables() const { return observables_; }

  // Of the following, all ranks call each.

  /// Begins to measure.
  void observe(ObserveSettings const& settings);
  void sample(std::span<double> row, bool counts_for_average);
  /// The hash of all agents, for the leader.
  [[nodiscard]] std::uint64_t state_hash() const;
  /// Writes the agents of this rank into the directory of a run. Returns the parts of all, for the leader. Errors:
  /// RunFailure, on the leader.
  [[nodiscard]] std::vector<CheckpointPart> write_part(std::filesystem::path const& directory,
                                                       SerializeAll const& serialize) const;
  /// Errors: Error, on all ranks.
  std::optional<Restored> restore(std::filesystem::path const& directory, SerializeAll const& serialize);

  /// What a WorldSimulation serializes; of the agents those of this rank.
  void serialize(Archive& archive);

 private:
  [[nodiscard]] CheckpointShare share() const;

  Communicator& ranks_;
  std::unique_ptr<AgentsOfRank> agents_;
  Counters counters_;
  ObservableSet observables_;
};

/// A run whose agents are divided among ranks, of which this one leads: it carries the run out as one process would,
/// and tells the others what to do before it does its own part of it. view() and the columns to be changed are those of
/// its own agents. The bits are those of one process.
class DividedSimulation final : public Simulation {
 public:
  /// The other ranks make theirs after announce().
  DividedSimulation(Communicator& ranks, std::unique_ptr<AgentsOfRank> agents)
      : ranks_(ranks), run_(ranks, std::move(agents)) {}
  DividedSimulation(DividedSimulation const&) = delete;
  DividedSimulation& operator=(DividedSimulation const&) = delete;
  ~DividedSimulation() override;

  /// Tells the other ranks to make their agents of such a run, which the caller then does too.
  static void announce(Communicator& ranks, Configuration const& configuration);

  /// Begins to measure.
  void observe(ObserveSettings const& settings);

  [[nodiscard]] Clock clock() const override { return own().clock(); }
  [[nodiscard]] double time_step() const override { return own().time_step(); }
  [[nodiscard]] Box const& box() const override { return own().box(); }
  [[nodiscard]] AgentsView view() const override { return own().view(); }
  [[nodiscard]] std::size_t agents() const override { return own().count(); }
  [[nodiscard]] std::uint64_t state_hash() const override;
  [[nodiscard]] std::vector<Count> counts() const override { return own().event_counts(run_.counters()); }
  [[nodiscard]] std::uint64_t pair_collisions() const override { return run_.counters().pair_collisions; }
  [[nodiscard]] std::vector<NamedColumn> columns_of_agents() override { return own().columns(); }
  [[nodiscard]] std::shared_ptr<void> release_columns() override { return own().release_columns(); }
  void require_valid() const override { own().require_valid(); }
  void advance(StopCondition const& stop_condition) override;
  void observe(std::unique_ptr<Observable> observable) override;
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return run_.observables().columns(); }
  void sample(std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return run_.observables().results(); }
  [[nodiscard]] std::vector<Distribution> distributions() const override { return run_.observables().distributions(); }
  [[nodiscard]] std::unique_ptr<FrameSource> frame_source() const override;
  void serialize(Archive& archive) override { run_.serialize(archive); }

  /// Every rank writes its agents; the checkpoint that names the parts comes next. `serialize` visits the whole run,
  /// this simulation inside.
  /// Errors: RunFailure.
  [[nodiscard]] std::vector<CheckpointPart> write_parts(std::filesystem::path const& directory,
                                                        SerializeAll const& serialize);
  /// Restores the newest checkpoint that is whole on all ranks. Errors: Error.
  std::optional<Restored> restore(std::filesystem::path const& directory, SerializeAll const& serialize);

 private:
  class Source;
  [[nodiscard]] AgentsOfRank const& own() const { return run_.agents(); }
  [[nodiscard]] AgentsOfRank& own() { return run_.agents(); }

  Communicator& ranks_;
  RunOfRank run_;
  mutable std::uint64_t frames_ = 0;  ///< handed out so far
};

/// What every other rank does for a DividedSimulation of the leader.
class RunHelper {
 public:
  explicit RunHelper(Communicator& ranks) : ranks_(ranks) {}

  void carry_out(TaskOfRanks task, MessageReader& message);

 private:
  void begin(MessageReader& message);
  void sample(MessageReader& message);
  void give_rows(MessageReader& message) const;

  Communicator& ranks_;
  Configuration configuration_;
  std::optional<RunOfRank> run_;
  std::map<std::uint64_t, ArrangedAgents> frames_;  ///< that the leader hands out, by number
};

}  // namespace gridlock
