#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/free_names.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/grid/detail/tile_division.hpp"
#include "gridlock/model/detail/steps_on_ranks.hpp"
#include "gridlock/parallel/detail/agent_homes.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/tasks.hpp"

namespace gridlock {

/// What a model says of its steps.
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

/// The part of one rank in the steps of agents that ranks divide among them: the agents go from their homes to the
/// rectangles in which they take turns, and come back. All ranks construct it and call bring_home() together.
template <class Model>
class StepsFromHomes {
 public:
  using Agents = typename World<Model>::Agents;
  using Share = ShareOf<Model>;

  /// Takes the agents out of `home`. The cells of the order are chosen here, unless the model fixes them.
  StepsFromHomes(Communicator& ranks, Model const& model, ShareOrder order,
                 std::optional<CellLayout> const& fixed_cells, Agents& home, NameBirths name_births = {})
      : ranks_(ranks) {
    home.become(rows_.ids, rows_.values);
    CellsOfStep const cells = cells_of_step(order.box(), order.cutoff, order.agents);
    CellLayout layout = fixed_cells.value_or(cells.layout);
    std::vector<Tiling::Rectangle> division = send_to_rectangles(order, layout);
    // Where agents crowd, ranks can share them fairly in fine cells alone.
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

  /// What has become of the agents of this rank, in the order of their Ids.
  void bring_home(bool does_last_step_count, Agents& home) {
    AgentRows<Agents> rows;
    share_->take_agents(does_last_step_count, rows.ids, rows.values);
    population_ = share_->population();
    events_ = share_->events();
    share_.reset();
    gridlock::bring_home(ranks_, rows);
    home.become(rows.ids, rows.values);
  }

  /// Of all ranks, after bring_home().
  [[nodiscard]] std::size_t population() const { return population_; }
  /// On this rank, after bring_home().
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
  // After them:
  std::size_t population_ = 0;
  EventCounts<Model> events_{};
};

/// Who dies leaves its name to those who are born.
inline std::vector<Id> names_of_births(FreeNames& names, std::span<Id const> deaths, std::size_t births) {
  for (Id const id : deaths) names.give_back(id);
  std::vector<Id> given(births);
  for (Id& id : given) id = names.take();
  return given;
}

/// What a rank has sent, and what has happened to its agents, after some steps.
template <class Model>
struct EndOfSteps {
  Traffic traffic;
  EventCounts<Model> events;
};

/// Moves agents on that ranks divide among them, of which this one leads: `own` has those whose home is here, `agents`
/// is the number of all. The bits are those of one process. Errors: as ModelEngine::advance().
template <class Model>
void lead_steps_from_homes(Communicator& ranks, Model const& model, StepsOfModel const& steps_of_model,
                           std::uint64_t threads, World<Model>& own, Counters& counters, std::size_t& agents,
                           FreeNames& names, StopCondition const& stop_condition) {
  require_good_step(own.clock.step, steps_of_model.cutoff, steps_of_model.time_step);
  if (stop_condition.is_reached(own.clock, counters.pair_collisions)) return;
  std::optional<StepsFromHomes<Model>> steps;
  std::optional<LeadingSteps<ShareOf<Model>>> leading;
  do_or_abandon(ranks, [&] {
    ShareOrder const order = {.width = own.box.width(),
                              .height = own.box.height(),
                              .is_periodic = own.box.is_periodic() ? std::uint64_t{1} : 0,
                              .seed = own.seed,
                              .clock = own.clock,
                              .cutoff = steps_of_model.cutoff,
                              .time_step = steps_of_model.time_step,
                              .threads = threads,
                              .agents = agents,
                              .columns = 0,
                              .rows = 0};
    send_task(ranks, TaskOfRanks::steps_from_homes, order);
    steps.emplace(
        ranks, model, order, steps_of_model.cells, own.agents,
        [&](std::span<Id const> deaths, std::size_t births) { return names_of_births(names, deaths, births); });
    leading.emplace(ranks, steps->share(), own.clock, steps_of_model.time_step, counters);
    leading->run(stop_condition);
    steps->bring_home(leading->does_last_step_count(), own.agents);
    agents = steps->population();
    EndOfSteps<Model> const end{.traffic = ranks.traffic(), .events = steps->events()};
    std::vector<Message> const of_ranks = gather(ranks, message_of(end));
    for (std::size_t rank = 0; rank < of_ranks.size(); ++rank) {
      auto const of_rank = MessageReader(of_ranks[rank]).template next<EndOfSteps<Model>>();
      ranks.note_traffic(rank, of_rank.traffic);
      for (std::size_t k = 0; k < of_rank.events.size(); ++k) own.events[k] += of_rank.events[k];
    }
  });
  leading->require_good_end();
}

/// The part of every other rank in it, after the task in the message.
template <class Model>
void follow_steps_from_homes(Communicator& ranks, Model const& model, std::optional<CellLayout> const& fixed_cells,
                             MessageReader& message, World<Model>& own, std::size_t& agents) {
  auto const order = message.next<ShareOrder>();
  own.clock = order.clock;
  StepsFromHomes<Model> steps(ranks, model, order, fixed_cells, own.agents);
  steps.bring_home(follow_steps(ranks, steps.share()), own.agents);
  agents = steps.population();
  EndOfSteps<Model> const end{.traffic = ranks.traffic(), .events = steps.events()};
  static_cast<void>(gather(ranks, message_of(end)));
}

}  // namespace gridlock
