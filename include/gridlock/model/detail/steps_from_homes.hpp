#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "gridlock/core/detail/agent_homes.hpp"
#include "gridlock/model/detail/on_ranks.hpp"

namespace gridlock {

/// The part of one rank in the steps of agents that ranks divide among them: the agents go from their homes to the rectangles in which they
/// take turns, and come back. All ranks construct it and call bring_home() together.
template <class Model>
class StepsFromHomes {
 public:
  using Agents = typename World<Model>::Agents;
  using Share = ModelShare<Model>;

  /// Takes the agents out of `home`. The cells of the order are not chosen yet.
  StepsFromHomes(Ranks& ranks, Model const& model, ShareOrder order, Agents& home, NameBirths name_births = {})
      : ranks_(ranks) {
    home.become(rows_.ids, rows_.values);
    CellsOfStep const cells = cells_of_step(order.box(), order.cutoff, order.agents);
    CellLayout layout = cells.layout;
    std::vector<Tiling::Rectangle> division = send_to_rectangles(order, layout);
    // Where agents crowd, ranks can share them fairly in fine cells alone.
    if (cells.finer && is_crowd_of_all(order, layout, division)) {
      layout = *cells.finer;
      division = send_to_rectangles(order, layout);
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
  [[nodiscard]] std::vector<Tiling::Rectangle> send_to_rectangles(ShareOrder const& order, CellLayout const& layout) {
    auto const& x = rows_.values.template values<X>();
    auto const& y = rows_.values.template values<Y>();
    std::vector<Tiling::Rectangle> division = divide_among_ranks(ranks_, order.box(), layout, x, y);
    RankDivision const owners(layout, division, rim_of(layout, order.cutoff), ranks_.rank());
    rows_ = exchanged_agents<Agents>(ranks_, rows_.ids, rows_.values, [&](std::size_t row) {
      return owners.owner_of({x[row], y[row]});
    });
    return division;
  }

  /// Each coarse cell belongs to one rank.
  [[nodiscard]] bool is_crowd_of_all(ShareOrder const& order, CellLayout const& layout,
                                     std::vector<Tiling::Rectangle> const& division) {
    CellCounts const counts(RankDivision(layout, division, rim_of(layout, order.cutoff), ranks_.rank()), layout,
                            rows_.values.template values<X>(), rows_.values.template values<Y>(),
                            [](std::size_t /*row*/) { return true; });
    return is_crowd(sum_over_ranks(ranks_, counts.pairs()), order.agents);
  }

  Ranks& ranks_;
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

template <class Model>
void add_events(EventCounts<Model>& sums, EventCounts<Model> const& events) {
  for (std::size_t k = 0; k < events.size(); ++k) sums[k] += events[k];
}

/// Moves agents on that ranks divide among them, of which this one leads: `own` has those whose home is here, `agents` is the number of
/// all. The bits are those of one process. Errors: as ModelEngine::advance().
template <class Model>
void lead_steps_from_homes(Ranks& ranks, Model const& model, std::uint64_t threads, World<Model>& own,
                           std::size_t& agents, FreeNames& names, StopCondition const& stop_condition) {
  require_good_step(own.clock.step, model.cutoff(), model.time_step());
  if (stop_condition.is_reached(own.clock, 0)) return;
  std::optional<StepsFromHomes<Model>> steps;
  Counters none;  // synchronous models keep none
  std::optional<LeadingSteps<ModelShare<Model>>> leading;
  do_or_abandon(ranks, [&] {
    ShareOrder const order =
        share_order(own.box, own.clock, own.seed, model.cutoff(), model.time_step(), threads, agents);
    send_task(ranks, TaskOfRanks::steps_from_homes, order);
    steps.emplace(ranks, model, order, own.agents, [&](std::span<Id const> deaths, std::size_t births) {
      return names_of_births(names, deaths, births);
    });
    leading.emplace(ranks, steps->share(), own.clock, model.time_step(), none);
    leading->run(stop_condition);
    steps->bring_home(leading->does_last_step_count(), own.agents);
    agents = steps->population();
    add_events<Model>(own.events, steps->events());
    for (std::size_t rank = 1; rank < ranks.count(); ++rank) {
      Ranks::Bytes const bytes = ranks.receive(rank);
      MessageReader message(bytes);
      ranks.note_traffic(rank, message.next<Traffic>());
      add_events<Model>(own.events, message.next<EventCounts<Model>>());
    }
    ranks.note_traffic(0, ranks.traffic());
  });
  leading->require_good_end();
}

/// The part of every other rank in it, after the task in the message.
template <class Model>
void follow_steps_from_homes(Ranks& ranks, Model const& model, MessageReader& message, World<Model>& own,
                             std::size_t& agents) {
  auto const order = message.next<ShareOrder>();
  own.clock = order.clock;
  StepsFromHomes<Model> steps(ranks, model, order, own.agents);
  steps.bring_home(follow_steps(ranks, steps.share()), own.agents);
  agents = steps.population();
  MessageWriter answer;
  answer.add(ranks.traffic());
  answer.add(steps.events());
  ranks.send(0, answer.take());
}

}  // namespace gridlock
