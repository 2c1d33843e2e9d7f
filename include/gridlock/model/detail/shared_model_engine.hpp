#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/detail/free_names.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/tiled_share.hpp"
#include "gridlock/model/model.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/parallel/detail/agent_exchange.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"

namespace gridlock {

/// The cutoff, the time step and the cells that a model asks for.
struct StepsOfModel {
  double cutoff = 0.0;
  double time_step = 0.0;
  std::optional<CellLayout> cells;  ///< empty if the model does not choose the cells
};

/// Asks a model for its cutoff, time step and cells. All processes call it; `world` has the agents of this process.
template <class Model>
StepsOfModel steps_of(Communicator& processes, Model const& model, World<Model> const& world) {
  return {.cutoff = cutoff_of(model, world, processes),
          .time_step = time_step_of(model, world, processes),
          .cells = cells_of(model, world, processes)};
}

/// Takes `steps` steps together with all other processes, or fewer if a turn fails; `failure` is then the first failure
/// of all processes. All processes call it.
template <class Share>
StepsTaken take_steps(Communicator& processes, Share& share, std::uint64_t steps, Counters& counters,
                      std::optional<FailedTurn>& failure) {
  std::uint64_t begun = 0;
  while (begun < steps && share.take_step()) ++begun;
  AnswerOfSteps const all = answer_of_all(
      processes,
      {.is_stop_asked = processes.is_stop_asked(), .failure = share.failure(), .counters = share.take_counters()});
  failure = all.failure;
  StepsTaken const taken{.whole = begun - (failure ? 1 : 0), .has_failed = failure.has_value()};
  for (std::uint64_t step = 0; step < taken.whole && step < all.counters.size(); ++step) {
    all.counters[step].add_to(counters);
  }
  return taken;
}

/// Sends the agents of a run to the processes that own their rectangles, takes steps there, and gives each process the
/// agents of its rectangle back. All processes construct it and call give_back() together.
template <class Model>
class StepsOfAll {
 public:
  using Agents = typename World<Model>::Agents;
  using Share = std::conditional_t<Model::schedule == Schedule::tiled, TiledModelShare<Model>, ModelShare<Model>>;

  /// Takes the agents out of `own`. Chooses the cells of the run, unless the model fixes them.
  StepsOfAll(Communicator& processes, Model const& model, SharedRun const& run,
             std::optional<CellLayout> const& fixed_cells, Agents& own, NameBirths name_births = {})
      : processes_(processes) {
    own.become(rows_.ids, rows_.values);
    CellsOfStep const cells = cells_of_step(run.box, run.cutoff, run.agents);
    Domain domain = send_to_rectangles(fixed_cells.value_or(cells.layout), run.cutoff);
    // Only fine cells divide a crowd of agents evenly among processes.
    if constexpr (Model::schedule == Schedule::synchronous) {
      if (cells.finer && is_crowd(domain, domain.cells(), rows_.values.template values<X>(),
                                  rows_.values.template values<Y>(), run.agents)) {
        domain = send_to_rectangles(*cells.finer, run.cutoff);
      }
    }
    share_.emplace(std::move(domain), model, run, std::move(rows_.ids), std::move(rows_.values),
                   std::move(name_births));
  }

  [[nodiscard]] Share& share() { return *share_; }

  /// Moves the agents that are in the rectangle of this process now to `own`, in the order of their Ids.
  void give_back(bool does_last_step_count, Agents& own) {
    AgentRows<Agents> rows;
    share_->take_agents(does_last_step_count, rows.ids, rows.values);
    events_ = share_->events();
    share_.reset();
    sort_agents(rows);
    own.become(rows.ids, rows.values);
  }

  /// Returns the events of this process. Contract: give_back() was called.
  [[nodiscard]] EventCounts<Model> const& events() const { return events_; }

 private:
  /// Sends every agent to the process that owns its rectangle of cells or tiles, and returns the division.
  [[nodiscard]] Domain send_to_rectangles(CellLayout const& cells, double cutoff) {
    auto const& x = rows_.values.template values<X>();
    auto const& y = rows_.values.template values<Y>();
    Domain domain = [&] {
      if constexpr (Model::schedule == Schedule::synchronous) {
        return Domain::of_cells(processes_, cells, cutoff, x, y);
      } else {
        return Domain::of_tiles(processes_, cells, [&](auto visit) {
          for (std::size_t row = 0; row < rows_.ids.size(); ++row) visit({x[row], y[row]});
        });
      }
    }();
    rows_ = exchanged_agents<Agents>(processes_, rows_.ids, rows_.values, [&](std::size_t row) {
      return domain.owner_of({x[row], y[row]});
    });
    return domain;
  }

  Communicator& processes_;
  AgentRows<Agents> rows_;  ///< the agents until share_ exists
  std::optional<Share> share_;
  EventCounts<Model> events_{};  ///< set by give_back()
};

/// Returns the Ids of `births` newborns, after the slots of the dead are freed.
inline std::vector<Id> names_of_births(FreeNames& names, std::span<Id const> deaths, std::size_t births) {
  for (Id const id : deaths) names.give_back(id);
  std::vector<Id> given(births);
  for (Id& id : given) id = names.take();
  return given;
}

/// Errors: Error, in all processes, for the agent outside the box with the lowest Id.
template <class Model>
void require_inside_box(Communicator& processes, World<Model> const& own,
                        std::function<void(std::function<void()> const&)> const& blame) {
  constexpr Id nobody = std::numeric_limits<Id>::max();
  std::size_t const row = find_outside(own.box, own.agents.template column<X>(), own.agents.template column<Y>());
  Id const outside = row < own.agents.size() ? own.agents.ids()[row] : nobody;
  Id const first = all_min(processes, outside);
  agree(processes, [&] {
    if (outside != nobody && outside == first) blame([&] { ModelEngine<Model>::require_inside(own); });
  });
}

/// Puts the first agents of this process into an empty world. With Model::first_agent() each process makes some of
/// them; else the root makes all agents and sends them to the other processes. All processes call it.
/// Errors: Error or RunFailure, in all processes.
template <class Model>
void start_together(Model const& model, World<Model>& own, Communicator& processes,
                    std::function<void(std::function<void()> const&)> const& blame) {
  using Agents = typename World<Model>::Agents;
  AgentRows<Agents> rows;
  FreeNames names;
  agree(processes, [&] {
    blame([&] {
      if constexpr (has_first_agents<Model>()) {
        std::uint64_t const all = model.agents_at_start();
        for (Id number = processes.rank(); number < all; number += processes.count()) {
          rows.ids.push_back(number);
          rows.values.resize(rows.ids.size());
          rows.values.put(rows.ids.size() - 1, model.first_agent(own, number));
        }
        names = FreeNames(all, {});
      } else if (processes.rank() == 0) {
        model.start(own);
        names = own.agents.free_names();
        own.agents.become(rows.ids, rows.values);
      }
    });
  });
  if constexpr (!has_first_agents<Model>()) scatter(processes, rows);
  own.agents.become(rows.ids, rows.values);
  own.agents.names_of_all() = std::move(names);
  require_inside_box(processes, own, blame);
}

/// Advances a model whose agents several processes share. The world of a process has the agents in its rectangle of the
/// box, in the order of their Ids; before the first step it may have any agents. The root also has the free Ids, in
/// Population::names_of_all(). All processes call each function together. The bits are those of a run of one process.
template <class Model>
class SharedModelEngine final : public EngineFor<Model> {
 public:
  SharedModelEngine(Model model, AllProcesses processes, std::uint64_t threads)
      : model_(std::move(model)), processes_(processes), threads_(threads) {}

  /// Errors: those of ModelEngine::advance(), in all processes.
  void advance(World<Model>& own, Counters& counters, StopCondition const& stop_condition) override {
    Communicator& processes = processes_.communicator();
    StepsOfModel const steps_of_model = steps_of(own);
    agree(processes, [&] { require_good_step(own.clock.step, steps_of_model.cutoff, steps_of_model.time_step); });
    if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
    std::exception_ptr thrown;
    std::optional<FailedTurn> failure;
    do_or_abandon(processes, [&] {
      SharedRun const run = {.box = own.box,
                             .seed = own.seed,
                             .clock = own.clock,
                             .cutoff = steps_of_model.cutoff,
                             .time_step = steps_of_model.time_step,
                             .threads = threads_,
                             .agents = static_cast<std::size_t>(processes_.sum(own.agents.size()))};
      NameBirths name_births;
      if (processes_.is_root()) {
        name_births = [&](std::span<Id const> deaths, std::size_t births) {
          return names_of_births(own.agents.names_of_all(), deaths, births);
        };
      }
      StepsOfAll<Model> steps(processes, model_, run, steps_of_model.cells, own.agents, std::move(name_births));
      thrown = take_steps_together(
          processes, own.clock, steps_of_model.time_step, counters, stop_condition,
          [&](std::uint64_t count) { return take_steps(processes, steps.share(), count, counters, failure); });
      steps.give_back(!failure, own.agents);
      EventCounts<Model> events = steps.events();
      all_sum(processes, std::span(events));
      for (std::size_t k = 0; k < events.size(); ++k) own.events[k] += events[k];
      note_traffic_of_all(processes);
    });
    if (thrown) std::rethrow_exception(thrown);
    agree(processes, [&] {
      if (failure) throw RunFailure(failure->reason);
    });
  }

  [[nodiscard]] double time_step_of(World<Model> const& own) const override { return steps_of(own).time_step; }
  /// Checks the agents of this process only.
  void require_valid(World<Model> const& own) const override {
    try {
      ModelEngine<Model>::require_inside(own);
    } catch (RunFailure const& failure) {
      throw Error(Problem{.what = failure.what()});
    }
  }
  [[nodiscard]] std::vector<Count> counts(World<Model> const& own, Counters const& /*counters*/) const override {
    return counts_of_events(own);
  }

  void take_restored(World<Model>& own) override {
    AgentRows<typename World<Model>::Agents> rows;
    own.agents.become(rows.ids, rows.values);
    scatter(processes_, rows);
    own.agents.become(rows.ids, rows.values);
    processes_.agree([&] {
      require_valid(own);
      auto const names = own.agents.ids();
      if (std::ranges::adjacent_find(names) == names.end()) return;
      throw Error(Problem{.what = "two agents of the checkpoint have one name"});
    });
  }

 private:
  [[nodiscard]] StepsOfModel steps_of(World<Model> const& own) const {
    return gridlock::steps_of(processes_.communicator(), model_, own);
  }

  Model model_;
  AllProcesses processes_;
  std::uint64_t threads_;
};

}  // namespace gridlock
