#pragma once

/// \file
/// A run advances a simulation: agents of any kind, the rule that moves them and their observables.
///
/// ```cpp
/// auto const mean_x = [](Simulation& simulation) {
///   simulation.advance({.step = simulation.clock().step + 100});
///   double sum = 0.0;
///   for (double const x : simulation.view().column<X>()) sum += x;
///   return sum / static_cast<double>(simulation.agents());
/// };
/// ```

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/agents_view.hpp"
#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/core/frame_source.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/event.hpp"

namespace gridlock {

/// The progress of the preparation of a simulation.
struct Preparation {
  double fraction = 1.0;
  std::string what;                              ///< the present stage: "quench"; empty at the end
  std::uint64_t work = 0;                        ///< a number that grows with the work done
  std::size_t stages = 0;                        ///< number of stages of the protocol; 0 without a protocol
  std::size_t finished = 0;                      ///< number of finished stages
  std::vector<std::uint64_t> state_hashes = {};  ///< at the end of each finished stage
};

/// A run advances a simulation: agents of any model, the engine that moves them, and observables.
///
/// Runs, their directories, trajectories, checkpoints, sweeps and the command line use only these functions.
class Simulation {
 public:
  Simulation() = default;
  Simulation(Simulation const&) = delete;
  Simulation& operator=(Simulation const&) = delete;
  virtual ~Simulation() = default;

  /// Returns whether advance() may be called; a simulation with a protocol must be prepared first.
  [[nodiscard]] virtual bool is_prepared() const { return true; }
  /// Continues the preparation until it ends or should_continue() returns false; returns whether it has ended. Errors:
  /// RunFailure if it cannot end.
  virtual bool prepare(std::function<bool()> const& /*should_continue*/) { return true; }
  [[nodiscard]] virtual Preparation preparation() const { return {}; }
  [[nodiscard]] virtual std::vector<Event> notes() const { return {}; }

  [[nodiscard]] virtual Clock clock() const = 0;
  /// Returns the physical time of one step.
  [[nodiscard]] virtual double time_step() const = 0;
  [[nodiscard]] virtual Box const& box() const = 0;
  /// Returns the present agents; see AgentsView for how long the view is valid.
  [[nodiscard]] virtual AgentsView view() const = 0;
  [[nodiscard]] virtual std::size_t agents() const { return view().size(); }
  [[nodiscard]] virtual std::uint64_t state_hash() const = 0;
  [[nodiscard]] virtual std::vector<Count> counts() const = 0;
  /// Returns how often the engine has checked its world, as a part of counts().
  [[nodiscard]] virtual std::vector<Count> audits() const { return {}; }

  /// Returns the number to compare with StopCondition::pair_collisions; 0 for agents that do not collide.
  [[nodiscard]] virtual std::uint64_t pair_collisions() const { return 0; }

  /// Returns the columns of the agents, whose values may be changed between two calls of advance(); see AgentsView for
  /// how long they are valid.
  [[nodiscard]] virtual std::vector<NamedColumn> columns_of_agents() = 0;
  /// Copies all columns and Ids to new memory, and returns the old memory, which keeps arrays in it valid.
  [[nodiscard]] virtual std::shared_ptr<void> release_columns() = 0;
  /// Throws Error for agents that the engine cannot advance correctly; call it after changing columns.
  virtual void require_valid() const = 0;

  /// Advances until the stop condition holds; the bits do not depend on the number of threads. Errors: RunFailure if an
  /// invariant breaks.
  virtual void advance(StopCondition const& stop_condition) = 0;

  /// Adds an observable, which is measured from now on. Errors: Error if the agents lack a column that it requires.
  virtual void observe(std::unique_ptr<Observable> observable) = 0;

  /// Returns the columns of the series besides step and time.
  [[nodiscard]] virtual std::vector<ColumnInfo> columns() const = 0;
  /// Writes one number for each column, or no_value, to `row`; see Observable::sample().
  virtual void sample(std::span<double> row, bool counts_for_average) = 0;
  [[nodiscard]] virtual std::vector<NamedEstimate> results() const = 0;
  [[nodiscard]] virtual std::vector<Distribution> distributions() const = 0;

  /// Returns the processes that share the simulation. All of them call each function that concerns all agents together,
  /// and get the same result.
  [[nodiscard]] virtual AllProcesses processes() const { return {}; }

  /// Calls `use` with all present agents and columns; if processes share them, in the root only. Errors: those of
  /// `use`, in all processes.
  virtual void give_frame(UseFrame const& use) const = 0;
  /// Returns all present agents and columns; if processes share them, in the root only.
  [[nodiscard]] Frame frame() const {
    Frame all;
    give_frame([&](FrameSource const& frame) { all = frame.whole(); });
    return all;
  }

  /// Returns the contacts of the agents if a protocol has just ended in a minimum of their energy.
  [[nodiscard]] virtual std::optional<FrameContacts> contacts() const { return std::nullopt; }

  /// Serializes everything on which the rest of the run depends: state, counts and data of the observables. Restored
  /// into a simulation from the same configuration, the run continues with the same bits.
  virtual void serialize(Archive& archive) = 0;
  /// Called in all processes after each has restored its part. Errors: Error, in all processes, for a state that cannot
  /// be continued.
  virtual void take_restored() {}
};

}  // namespace gridlock
