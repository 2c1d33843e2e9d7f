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

/// How far the preparation of a simulation has come.
struct Preparation {
  double fraction = 1.0;
  std::string what;          ///< is being done now: "quench"; empty at the end
  std::uint64_t work = 0;    ///< grows with everything that is done
  std::size_t stages = 0;    ///< of the protocol; 0 without one
  std::size_t finished = 0;  ///< of these
};

/// A run advances a simulation: agents of any kind, the rule that moves them and their observables.
///
/// The loop of a run, its directory, trajectories, checkpoints, sweeps and the command line know nothing else.
class Simulation {
 public:
  Simulation() = default;
  Simulation(Simulation const&) = delete;
  Simulation& operator=(Simulation const&) = delete;
  virtual ~Simulation() = default;

  /// Whether advance() may be called; a simulation with a protocol is prepared first.
  [[nodiscard]] virtual bool is_prepared() const { return true; }
  /// Goes on with the preparation until it has ended or should_continue says no; returns whether it has ended.
  /// Errors: RunFailure where it cannot end.
  virtual bool prepare(std::function<bool()> const& /*should_continue*/) { return true; }
  [[nodiscard]] virtual Preparation preparation() const { return {}; }
  /// Notes on how the preparation went.
  [[nodiscard]] virtual std::vector<Event> notes() const { return {}; }

  [[nodiscard]] virtual Clock clock() const = 0;
  /// The physical time of one step.
  [[nodiscard]] virtual double time_step() const = 0;
  [[nodiscard]] virtual Box const& box() const = 0;
  /// The agents as they are now; see AgentsView for how long it is valid.
  [[nodiscard]] virtual AgentsView view() const = 0;
  [[nodiscard]] virtual std::size_t agents() const { return view().size(); }
  /// The bitwise identity of the state.
  [[nodiscard]] virtual std::uint64_t state_hash() const = 0;
  [[nodiscard]] virtual std::vector<Count> counts() const = 0;
  /// How often the engine has checked its world, by name, as a part of counts().
  [[nodiscard]] virtual std::vector<Count> audits() const { return {}; }

  /// The number that StopCondition::pair_collisions is compared with; 0 for agents that do not collide.
  [[nodiscard]] virtual std::uint64_t pair_collisions() const { return 0; }

  /// The columns of the agents, to be changed between two calls of advance(); see AgentsView for how long they are
  /// valid.
  [[nodiscard]] virtual std::vector<NamedColumn> columns_of_agents() = 0;
  /// Goes on with a copy of all columns and Ids, and returns the old memory for those who have arrays of it.
  [[nodiscard]] virtual std::shared_ptr<void> release_columns() = 0;
  /// Throws Error for agents that the engine cannot advance rightly; to be asked after changes from outside.
  virtual void require_valid() const = 0;

  /// Moves on until the stop condition holds; the bits do not depend on the number of threads.
  /// Errors: RunFailure where an invariant breaks.
  virtual void advance(StopCondition const& stop_condition) = 0;

  /// Measures this too, from now on. Errors: Error where the agents lack a column that it requires.
  virtual void observe(std::unique_ptr<Observable> observable) = 0;

  /// The columns of the series besides step and time.
  [[nodiscard]] virtual std::vector<ColumnInfo> columns() const = 0;
  /// Measures now: one number for each column, or no_value; see Observable::sample().
  virtual void sample(std::span<double> row, bool counts_for_average) = 0;
  [[nodiscard]] virtual std::vector<NamedEstimate> results() const = 0;
  [[nodiscard]] virtual std::vector<Distribution> distributions() const = 0;

  /// The processes that share it: they call all functions that speak of all agents together, and get the same.
  [[nodiscard]] virtual AllProcesses processes() const { return {}; }

  /// Gives `use` all agents and all columns as they are now, in the root alone where processes share them.
  /// Errors: those of `use`, in all processes.
  virtual void give_frame(UseFrame const& use) const = 0;
  /// The same at once.
  [[nodiscard]] Frame frame() const {
    Frame all;
    give_frame([&](FrameSource const& frame) { all = frame.whole(); });
    return all;
  }

  /// The contacts of the agents, where a protocol has just ended in a minimum of their energy.
  [[nodiscard]] virtual std::optional<FrameContacts> contacts() const { return std::nullopt; }

  /// Everything that the rest of the run depends on: state, counts, and what the observables have gathered. Restored
  /// into a simulation made from the same configuration, the run continues with the same bits.
  virtual void serialize(Archive& archive) = 0;
  /// All processes that share it have restored their parts. Errors: Error, in all, for what cannot be continued.
  virtual void take_restored() {}
};

}  // namespace gridlock
