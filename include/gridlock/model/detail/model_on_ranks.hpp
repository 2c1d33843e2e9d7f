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
#include <utility>
#include <vector>

#include "gridlock/core/detail/free_names.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/steps_on_ranks.hpp"
#include "gridlock/model/model.hpp"
#include "gridlock/model/model_engine.hpp"
#include "gridlock/parallel/detail/agent_exchange.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

/// The cutoff, the time step and the cells that a model asks for.
struct StepsOfModel {
  double cutoff = 0.0;
  double time_step = 0.0;
  std::optional<CellLayout> cells;  ///< where the model fixes them
};

/// All ranks call it; `world` has the agents of this one.
template <class Model>
StepsOfModel steps_of(Communicator& ranks, Model const& model, World<Model> const& world) {
  return {.cutoff = cutoff_of(model, world, ranks),
          .time_step = time_step_of(model, world, ranks),
          .cells = cells_of(model, world, ranks)};
}

/// The part of one rank in the steps of agents that ranks divide among them: the agents go to the rectangles in which
/// they take turns, and stay where they are then. All ranks construct it and call give_back() together.
template <class Model>
class StepsOfAll {
 public:
  using Agents = typename World<Model>::Agents;
  using Share = ShareOf<Model>;

  /// Takes the agents out of `own`. The cells of the order are chosen here, unless the model fixes them.
  StepsOfAll(Communicator& ranks, Model const& model, ShareOrder order, std::optional<CellLayout> const& fixed_cells,
             Agents& own, NameBirths name_births = {})
      : ranks_(ranks) {
    own.become(rows_.ids, rows_.values);
    CellsOfStep const cells = cells_of_step(order.box(), order.cutoff, order.agents);
    CellLayout layout = fixed_cells.value_or(cells.layout);
    std::vector<Tiling::Rectangle> division = send_to_rectangles(order, layout);
    // Ranks can share a crowd of agents fairly in fine cells alone.
    if constexpr (Model::schedule == Schedule::synchronous) {
      if (cells.finer && is_crowd_of_all(order, layout, division)) {
        layout = *cells.finer;
        division = send_to_rectangles(order, layout);
      }
    }
    order.set_cells(layout);
    share_.emplace(ranks, model, order, std::move(division), std::move(rows_.ids), std::move(rows_.values),
                   std::move(name_births));
  }

  [[nodiscard]] Share& share() { return *share_; }

  /// Gives this rank the agents that are in its rectangle now, in the order of their Ids.
  void give_back(bool does_last_step_count, Agents& own) {
    AgentRows<Agents> rows;
    share_->take_agents(does_last_step_count, rows.ids, rows.values);
    events_ = share_->events();
    share_.reset();
    sort_agents(rows);
    own.become(rows.ids, rows.values);
  }

  /// On this rank, after give_back().
  [[nodiscard]] EventCounts<Model> const& events() const { return events_; }

 private:
  /// Each rank gets the agents of its rectangle: of cells, or of tiles.
  [[nodiscard]] std::vector<Tiling::Rectangle> send_to_rectangles(ShareOrder& order, CellLayout const& layout) {
    auto const& x = rows_.values.template values<X>();
    auto const& y = rows_.values.template values<Y>();
    order.set_cells(layout);
    std::vector<Tiling::Rectangle> division = divide(order.box(), layout);
    RankDivision const owners = Share::division_of(order, division, ranks_.rank());
    rows_ = exchanged_agents<Agents>(ranks_, rows_.ids, rows_.values, [&](std::size_t row) {
      return owners.owner_of({x[row], y[row]});
    });
    return division;
  }

  [[nodiscard]] std::vector<Tiling::Rectangle> divide([[maybe_unused]] Box const& box, CellLayout const& layout) {
    auto const& x = rows_.values.template values<X>();
    auto const& y = rows_.values.template values<Y>();
    if constexpr (Model::schedule == Schedule::synchronous) {
      return divide_among_ranks(ranks_, box, layout, x, y);
    } else {
      Tiling const tiling(layout);
      TileFinder const finder(layout, tiling);
      std::vector<std::uint64_t> agents_of_tile(tiling.tiles().size(), 0);
      for (std::size_t row = 0; row < rows_.ids.size(); ++row) ++agents_of_tile[finder.tile_of({x[row], y[row]})];
      all_sum(ranks_, agents_of_tile);
      return divide_tiles(tiling, agents_of_tile, ranks_.count());
    }
  }

  /// Each coarse cell belongs to one rank.
  [[nodiscard]] bool is_crowd_of_all(ShareOrder const& order, CellLayout const& layout,
                                     std::vector<Tiling::Rectangle> const& division) {
    CellCounts const counts(RankDivision(layout, division, rim_of(layout, order.cutoff), ranks_.rank()), layout,
                            rows_.values.template values<X>(), rows_.values.template values<Y>(),
                            [](std::size_t /*row*/) { return true; });
    return is_crowd(all_sum(ranks_, counts.pairs()), order.agents);
  }

  Communicator& ranks_;
  AgentRows<Agents> rows_;  ///< before there is a share
  std::optional<Share> share_;
  EventCounts<Model> events_{};  ///< after them
};

/// A dead agent leaves its name to one that is born.
inline std::vector<Id> names_of_births(FreeNames& names, std::span<Id const> deaths, std::size_t births) {
  for (Id const id : deaths) names.give_back(id);
  std::vector<Id> given(births);
  for (Id& id : given) id = names.take();
  return given;
}

/// Errors: Error, on all ranks, for the agent outside the box that one process would name.
template <class Model>
void require_inside_box(Communicator& ranks, World<Model> const& own,
                        std::function<void(std::function<void()> const&)> const& blame) {
  constexpr Id nobody = std::numeric_limits<Id>::max();
  std::size_t const row = find_outside(own.box, own.agents.template column<X>(), own.agents.template column<Y>());
  Id const outside = row < own.agents.size() ? own.agents.ids()[row] : nobody;
  Id const first = all_min(ranks, outside);
  agree(ranks, [&] {
    if (outside != nobody && outside == first) blame([&] { ModelEngine<Model>::require_inside(own); });
  });
}

/// Puts the first agents of this rank into an empty world: each rank makes its own where they are functions of their
/// numbers; else the root makes all, hands them out and forgets them. All call it.
/// Errors: Error or RunFailure, on all ranks.
template <class Model>
void start_on_ranks(Model const& model, World<Model>& own, Communicator& ranks,
                    std::function<void(std::function<void()> const&)> const& blame) {
  using Agents = typename World<Model>::Agents;
  AgentRows<Agents> rows;
  FreeNames names;
  agree(ranks, [&] {
    blame([&] {
      if constexpr (has_first_agents<Model>()) {
        std::uint64_t const all = model.agents_at_start();
        for (Id number = ranks.rank(); number < all; number += ranks.count()) {
          rows.ids.push_back(number);
          rows.values.resize(rows.ids.size());
          rows.values.put(rows.ids.size() - 1, model.first_agent(own, number));
        }
        names = FreeNames(all, {});
      } else if (ranks.rank() == 0) {
        model.start(own);
        names = own.agents.free_names();
        own.agents.become(rows.ids, rows.values);
      }
    });
  });
  if constexpr (!has_first_agents<Model>()) scatter(ranks, rows);
  own.agents.become(rows.ids, rows.values);
  own.agents.names_of_all() = std::move(names);
  require_inside_box(ranks, own, blame);
}

/// Advances a model on several ranks. The world of each has the agents that are in its rectangle of the box, in the
/// order of their Ids, and before the first step any; the root also has the names that are free, as
/// Population::names_of_all(). All ranks call each function together. The bits are those of one process.
template <class Model>
class ModelOnRanks final : public EngineFor<Model> {
 public:
  ModelOnRanks(Model model, AllProcesses processes, std::uint64_t threads)
      : model_(std::move(model)), processes_(processes), threads_(threads) {}

  /// Errors: as ModelEngine::advance(), on all ranks.
  void advance(World<Model>& own, Counters& counters, StopCondition const& stop_condition) override {
    Communicator& ranks = processes_.communicator();
    StepsOfModel const steps_of_model = steps_of(own);
    agree(ranks, [&] { require_good_step(own.clock.step, steps_of_model.cutoff, steps_of_model.time_step); });
    if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
    std::exception_ptr thrown;
    std::optional<FailedTurn> failure;
    do_or_abandon(ranks, [&] {
      ShareOrder const order = {.width = own.box.width(),
                                .height = own.box.height(),
                                .is_periodic = own.box.is_periodic() ? std::uint64_t{1} : 0,
                                .seed = own.seed,
                                .clock = own.clock,
                                .cutoff = steps_of_model.cutoff,
                                .time_step = steps_of_model.time_step,
                                .threads = threads_,
                                .agents = processes_.sum(own.agents.size()),
                                .columns = 0,
                                .rows = 0};
      NameBirths name_births;
      if (processes_.is_root()) {
        name_births = [&](std::span<Id const> deaths, std::size_t births) {
          return names_of_births(own.agents.names_of_all(), deaths, births);
        };
      }
      StepsOfAll<Model> steps(ranks, model_, order, steps_of_model.cells, own.agents, std::move(name_births));
      thrown = take_steps_together(
          ranks, own.clock, steps_of_model.time_step, counters, stop_condition,
          [&](std::uint64_t count) { return take_steps(ranks, steps.share(), count, counters, failure); });
      steps.give_back(!failure, own.agents);
      EventCounts<Model> events = steps.events();
      all_sum(ranks, std::span(events));
      for (std::size_t k = 0; k < events.size(); ++k) own.events[k] += events[k];
      note_traffic_of_all(ranks);
    });
    if (thrown) std::rethrow_exception(thrown);
    agree(ranks, [&] {
      if (failure) throw RunFailure(failure->reason);
    });
  }

  [[nodiscard]] double time_step_of(World<Model> const& own) const override { return steps_of(own).time_step; }
  /// Looks at the agents of this rank alone.
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
