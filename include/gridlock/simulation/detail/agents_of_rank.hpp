#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

namespace gridlock {

/// All agents of a frame in the order of their Ids: each rank has a block of the rows.
struct ArrangedAgents {
  RowDivision rows;
  AgentsView own;
  std::shared_ptr<void const> memory;  ///< of `own`
};

/// What one of several ranks has of the agents of a run that are divided among them: nobody has all. Of any model; the
/// run itself is a DividedSimulation on the leader.
class AgentsOfRank {
 public:
  AgentsOfRank() = default;
  AgentsOfRank(AgentsOfRank const&) = delete;
  AgentsOfRank& operator=(AgentsOfRank const&) = delete;
  virtual ~AgentsOfRank() = default;

  [[nodiscard]] virtual Box const& box() const = 0;
  /// Of others than the leader as of the last sample.
  [[nodiscard]] virtual Clock const& clock() const = 0;
  virtual void set_clock(Clock const& clock) = 0;
  [[nodiscard]] virtual std::uint64_t seed() const = 0;
  /// Of this rank.
  [[nodiscard]] virtual AgentsView view() const = 0;
  [[nodiscard]] virtual std::vector<NamedColumn> columns() = 0;
  [[nodiscard]] virtual std::shared_ptr<void> release_columns() = 0;
  [[nodiscard]] virtual Snapshot snapshot(Counters const& counters, Communicator& processes) const = 0;
  [[nodiscard]] virtual std::uint64_t sum_of_hashes() const = 0;
  /// Of all ranks.
  [[nodiscard]] virtual std::size_t count() const = 0;
  /// The rows that each rank has for the whole run, in the order of the Ids; nothing where agents come and go and have
  /// homes, see home_of().
  [[nodiscard]] virtual RowDivision const* rows() const { return nullptr; }

  /// What is measured of them.
  [[nodiscard]] virtual std::vector<std::unique_ptr<Observable>> make_observables(ObserveSettings const& settings,
                                                                                  Snapshot const& start) const = 0;
  /// What a WorldSimulation serializes as its world; of the agents those of this rank.
  virtual void serialize(Archive& archive) = 0;

  // Of the following, all ranks call each.

  /// A checkpoint has been restored: agents go to the ranks that have them. Errors: Error, on all ranks.
  virtual void bring_home() {}
  [[nodiscard]] virtual ArrangedAgents arranged() const = 0;

  /// What every other rank does where the leader has sent a task of these agents alone: steps, searches. Whether it was
  /// one.
  virtual bool carry_out(TaskOfRanks task, MessageReader& message) = 0;

  // The leader alone, which tells the others.

  virtual void advance(Counters& counters, StopCondition const& stop_condition) = 0;
  [[nodiscard]] virtual double time_step() const = 0;
  [[nodiscard]] virtual std::vector<Count> event_counts(Counters const& counters) const = 0;
  /// Throws Error for agents that cannot be advanced rightly.
  virtual void require_valid() const = 0;
};

}  // namespace gridlock
