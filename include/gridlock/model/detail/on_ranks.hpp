#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/detail/ranks.hpp"
#include "gridlock/core/detail/settings_message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/model/detail/share.hpp"
#include "gridlock/model/detail/tiled_share.hpp"

namespace gridlock {

/// Whether ranks can share the steps of a model: its agents take their turns all at once or tile by tile, and what it asks of the whole
/// world stays the same.
template <class Model>
consteval bool can_be_shared() {
  constexpr bool has_cells = requires(Model const& model, World<Model> const& world) { model.cells(world); };
  return asks_world_once<Model>() &&
         ((Model::schedule == Schedule::synchronous && !has_cells) || Model::schedule == Schedule::tiled);
}

/// What one rank has in the steps of a model.
template <class Model>
using ShareOf = std::conditional_t<Model::schedule == Schedule::tiled, TiledModelShare<Model>, ModelShare<Model>>;

/// What another rank says of some steps.
struct AnswerOfShare {
  std::uint64_t is_stop_asked = 0;
  std::uint64_t has_failed = 0;
};

/// What the turns of a rank have counted since the last call, where they count.
template <class Share>
std::vector<SumsOfTile> sums_of(Share& share) {
  if constexpr (requires { share.take_sums(); }) {
    return share.take_sums();
  } else {
    return {};
  }
}

/// The rows of one rank, in the order of their cells, one message after the other.
template <class Agents>
class RowsOfRank {
 public:
  using Key = std::tuple<std::uint64_t, Id>;  ///< cell and Id
  static constexpr Key end{std::numeric_limits<std::uint64_t>::max(), std::numeric_limits<Id>::max()};

  explicit RowsOfRank(std::function<Ranks::Bytes()> next_message) : next_message_(std::move(next_message)) { refill(); }

  [[nodiscard]] Key front() const { return next_ < ids_.size() ? Key{cells_[next_], ids_[next_]} : end; }
  void pop_into(LargeArray<Id>& ids, typename Agents::AllValues& values, std::size_t row) {
    ids[row] = ids_[next_];
    values.copy(row, values_, next_);
    if (++next_ == ids_.size()) refill();
  }

 private:
  void refill() {
    Ranks::Bytes const bytes = next_message_();
    MessageReader message(bytes);
    auto const count = message.next<std::uint64_t>();
    cells_ = message.next_values<std::uint32_t>(count);
    ids_.clear();
    values_.resize(0);
    append_agents(message, count, ids_, values_);
    next_ = 0;
  }

  std::function<Ranks::Bytes()> next_message_;
  std::vector<std::uint32_t> cells_;
  LargeArray<Id> ids_;
  typename Agents::AllValues values_;
  std::size_t next_ = 0;
};

/// The leader's part of the steps of a share, from look to look at the stop condition.
template <class Share>
class LeadingSteps {
 public:
  LeadingSteps(Ranks& ranks, Share& share, Clock& clock, double time_step, Counters& counters)
      : ranks_(ranks), share_(share), clock_(clock), time_step_(time_step), counters_(counters) {}

  /// All ranks are back from their steps when it returns, whatever the stop condition has thrown.
  void run(StopCondition const& stop_condition) {
    StepsBetweenLooks looks(ranks_);
    while (!stop_condition.is_reached(clock_, counters_.pair_collisions)) {
      looks.begin();
      std::uint64_t const done = take_steps(steps_until(stop_condition, looks.steps()));
      if (first_failure_) break;
      try {
        if (stop_condition.stops_here()) break;
      } catch (...) {
        thrown_ = std::current_exception();
        break;
      }
      looks.end(done);
    }
    MessageWriter message;
    message.add(std::uint64_t{0});
    message.add(does_last_step_count() ? std::uint64_t{1} : 0);
    send_to_others(ranks_, message.take());
  }

  [[nodiscard]] bool does_last_step_count() const { return !first_failure_; }

  /// Throws what the stop condition has thrown, or RunFailure for a turn that has failed.
  void require_good_end() const {
    if (thrown_) std::rethrow_exception(thrown_);
    if (first_failure_) throw RunFailure(first_failure_->reason);
  }

 private:
  /// How many steps may be taken before a look at the stop condition.
  [[nodiscard]] std::uint64_t steps_until(StopCondition const& stop, std::uint64_t most) const {
    if constexpr (requires { share_.take_sums(); }) {
      // Who waits for collisions stops at the first step that has enough.
      if (stop.pair_collisions != StopCondition().pair_collisions) return 1;
      constexpr std::uint64_t most_sums = 1 << 16;
      most = std::clamp<std::uint64_t>(most, 1, most_sums / share_.tiles_of_all() + 1);
    }
    Clock clock = clock_;
    std::uint64_t steps = 0;
    while (steps < most && !stop.is_reached(clock, 0)) {
      advance(clock);
      ++steps;
    }
    return steps;
  }
  void advance(Clock& clock) const {
    ++clock.step;
    clock.time += time_step_;
  }

  /// Returns how many steps were taken.
  std::uint64_t take_steps(std::uint64_t steps) {
    send_to_others(ranks_, message_of(steps));
    std::uint64_t begun = 0;
    while (begun < steps && share_.take_step()) ++begun;
    note_failure(share_.failure());
    std::vector<SumsOfTile> sums = sums_of(share_);
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      Ranks::Bytes const bytes = ranks_.receive(rank);
      MessageReader message(bytes);
      auto const answer = message.next<AnswerOfShare>();
      if (answer.is_stop_asked != 0) ranks_.ask_to_stop();
      if (answer.has_failed != 0) {
        auto const cell = message.next<std::uint64_t>();
        auto const agent = message.next<Id>();
        note_failure(FailedTurn{.cell = cell, .agent = agent, .reason = message.next_text()});
      }
      std::ranges::copy(message.rest<SumsOfTile>(), std::back_inserter(sums));
    }
    std::uint64_t const whole = begun - (first_failure_ ? 1 : 0);
    for (std::uint64_t n = 0; n < whole; ++n) advance(clock_);
    add_sums(sums);
    return whole;
  }

  /// In the order of one process: sums of floating-point numbers depend on it.
  void add_sums(std::span<SumsOfTile> sums) {
    std::ranges::sort(sums, {}, [](SumsOfTile const& of_tile) { return std::pair(of_tile.step, of_tile.tile); });
    for (SumsOfTile const& of_tile : sums) {
      if (of_tile.step < clock_.step) add(counters_, of_tile.counters);
    }
  }

  /// The first one is that at which one process would have stopped.
  void note_failure(std::optional<FailedTurn> const& failure) {
    if (!failure) return;
    if (first_failure_ &&
        std::tuple(first_failure_->cell, first_failure_->agent) <= std::tuple(failure->cell, failure->agent)) {
      return;
    }
    first_failure_ = failure;
  }

  Ranks& ranks_;
  Share& share_;
  Clock& clock_;
  double time_step_;
  Counters& counters_;
  std::exception_ptr thrown_;  ///< by the stop condition
  std::optional<FailedTurn> first_failure_;
};

/// The part of every other rank in them. Returns whether the last step counts.
template <class Share>
bool follow_steps(Ranks& ranks, Share& share) {
  while (true) {
    Ranks::Bytes const bytes = ranks.receive(0);
    MessageReader reader(bytes);
    auto const steps = reader.next<std::uint64_t>();
    if (steps == 0) return reader.next<std::uint64_t>() != 0;
    std::uint64_t begun = 0;
    while (begun < steps && share.take_step()) ++begun;
    MessageWriter answer;
    answer.add(AnswerOfShare{.is_stop_asked = ranks.is_stop_asked() ? std::uint64_t{1} : 0,
                             .has_failed = share.failure() ? std::uint64_t{1} : 0});
    if (auto const& failure = share.failure()) {
      answer.add(failure->cell);
      answer.add(failure->agent);
      answer.add_text(failure->reason);
    }
    answer.add_all(std::span<SumsOfTile const>(sums_of(share)));
    ranks.send(0, answer.take());
  }
}

/// What a rank must know of steps of these agents, of which there are so many on all ranks.
inline ShareOrder share_order(Box const& box, Clock const& clock, std::uint64_t seed, double cutoff, double time_step,
                              std::uint64_t threads, std::size_t agents) {
  return {.width = box.width(),
          .height = box.height(),
          .is_periodic = box.is_periodic() ? std::uint64_t{1} : 0,
          .seed = seed,
          .clock = clock,
          .cutoff = cutoff,
          .time_step = time_step,
          .threads = threads,
          .agents = agents,
          .columns = 0,
          .rows = 0};
}

/// The leader's side of one advance() of a world that it has alone. It has all agents, as they were when it began, with the names that
/// they have by now.
template <class Model>
class LeadingModel {
 public:
  using Agents = typename World<Model>::Agents;

  LeadingModel(Ranks& ranks, Model const& model, std::uint64_t threads, World<Model>& world, Counters& counters)
      : ranks_(ranks),
        model_(model),
        world_(world),
        cutoff_(cutoff_of(model, world)),
        time_step_(time_step_of(model, world)) {
    hand_out(threads);
    steps_.emplace(ranks, *share_, world.clock, time_step_, counters);
  }

  void run(StopCondition const& stop_condition) {
    steps_->run(stop_condition);
    gather();
  }
  void require_good_end() const { steps_->require_good_end(); }

 private:
  /// The cells in which the agents are divided.
  [[nodiscard]] CellLayout cells() const {
    if constexpr (requires { model_.cells(world_); }) {
      return model_.cells(world_);
    } else {
      CellsOfStep const cells = cells_of_step(world_.box, cutoff_, world_.agents.size());
      if constexpr (Model::schedule == Schedule::tiled) return cells.layout;
      // Where agents crowd, ranks can share them fairly in fine cells alone.
      bool const is_finer =
          cells.finer && is_crowd(cells.layout, world_.agents.template column<X>(), world_.agents.template column<Y>());
      return is_finer ? *cells.finer : cells.layout;
    }
  }

  /// The cells of each rank, or its tiles where agents take turns in tiles.
  [[nodiscard]] std::vector<Tiling::Rectangle> divide(CellLayout const& layout) const {
    auto const x = world_.agents.template column<X>();
    auto const y = world_.agents.template column<Y>();
    if constexpr (Model::schedule == Schedule::tiled) {
      Tiling const tiling(layout);
      TileFinder const finder(layout, tiling);
      std::vector<std::uint64_t> agents_of_tile(tiling.tiles().size(), 0);
      for (std::size_t row = 0; row < x.size(); ++row) ++agents_of_tile[finder.tile_of({x[row], y[row]})];
      return divide_tiles(tiling, agents_of_tile, ranks_.count());
    } else {
      return divide_among_ranks(world_.box, layout, x, y, ranks_.count());
    }
  }

  void hand_out(std::uint64_t threads) {
    CellLayout const layout = cells();
    std::vector<Tiling::Rectangle> const division = divide(layout);
    ShareOrder order =
        share_order(world_.box, world_.clock, world_.seed, cutoff_, time_step_, threads, world_.agents.size());
    order.set_cells(layout);
    send_order(order, division);
    LargeArray<Id> ids;
    typename Agents::AllValues values;
    hand_out_agents(ShareOf<Model>::division_of(order, division, 0), ids, values);
    share_.emplace(ranks_, model_, order, division, std::move(ids), std::move(values),
                   [this](std::span<Id const> deaths, std::size_t births) { return name_births(deaths, births); });
  }

  void send_order(ShareOrder const& order, std::vector<Tiling::Rectangle> const& division) {
    MessageWriter message;
    message.add(TaskOfRanks::steps_of_model);
    message.add_text(Model::name);
    add_settings(message, [&]([[maybe_unused]] SettingVisitor& visitor) {
      if constexpr (requires { model_.describe(visitor); }) model_.describe(visitor);
    });
    message.add(order);
    message.add_all(std::span<Tiling::Rectangle const>(division));
    send_to_others(ranks_, message.take());
  }

  /// Sends every rank its agents, in messages of bounded length of which an empty one is the last; its own to `ids`, `values`.
  void hand_out_agents(RankDivision const& division, LargeArray<Id>& ids, typename Agents::AllValues& values) {
    Agents const& agents = world_.agents;
    auto const x = agents.template column<X>();
    auto const y = agents.template column<Y>();
    std::vector<std::vector<std::uint32_t>> rows_of_rank(ranks_.count());
    auto const send = [&](std::size_t rank) {
      MessageWriter message;
      message.add(std::uint64_t{rows_of_rank[rank].size()});
      add_agents(message, agents.ids().data(), agents.values(), rows_of_rank[rank]);
      rows_of_rank[rank].clear();
      if (rank > 0) {
        ranks_.send(rank, message.take());
      } else {
        Ranks::Bytes const bytes = message.take();
        MessageReader reader(bytes);
        append_agents(reader, reader.template next<std::uint64_t>(), ids, values);
      }
    };
    for (std::uint32_t row = 0; row < agents.size(); ++row) {
      std::size_t const rank = division.owner_of({x[row], y[row]});
      rows_of_rank[rank].push_back(row);
      if (rows_of_rank[rank].size() == agents_of_message) send(rank);
    }
    for (std::size_t rank = 0; rank < ranks_.count(); ++rank) {
      if (!rows_of_rank[rank].empty()) send(rank);
      if (rank > 0) send(rank);
    }
  }

  /// Of a step that is not the last one, see ModelShare: who dies leaves its name to those who are born.
  std::vector<Id> name_births(std::span<Id const> deaths, std::size_t births) {
    remove_agents(world_.agents, deaths);
    std::vector<Id> names(births);
    for (Id& name : names) {
      name = std::apply([&](auto... values) { return world_.agents.add(values...); }, typename Agents::Values{});
    }
    return names;
  }

  /// Brings the world to where one process would have it, the order of its rows included: observables add in that order.
  void gather() {
    std::vector<Ranks::Bytes> own;
    share_->send_agents(steps_->does_last_step_count(),
                        [&](Ranks::Bytes message) { own.push_back(std::move(message)); });
    std::size_t next_own = 0;
    std::vector<RowsOfRank<Agents>> sources;
    sources.emplace_back([&] { return std::move(own[next_own++]); });
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      sources.emplace_back([this, rank] { return ranks_.receive(rank); });
    }
    merge(sources);
    std::vector<DeferredCommands<Model>> commands(share_->commands().begin(), share_->commands().end());
    add_events(share_->events());
    for (std::size_t rank = 1; rank < ranks_.count(); ++rank) {
      Ranks::Bytes const bytes = ranks_.receive(rank);
      MessageReader message(bytes);
      ranks_.note_traffic(rank, message.next<Traffic>());
      add_events(message.next<EventCounts<Model>>());
      commands.push_back(read_commands(message));
    }
    ranks_.note_traffic(0, ranks_.traffic());
    share_.reset();
    if (steps_->does_last_step_count()) apply_commands<Model>(world_, commands);
  }

  void merge(std::vector<RowsOfRank<Agents>>& sources) {
    std::size_t const count = world_.agents.size();
    LargeArray<Id> ids(count);
    typename Agents::AllValues values;
    values.resize(count);
    for (std::size_t row = 0; row < count;) {
      auto const least = std::ranges::min_element(sources, {}, &RowsOfRank<Agents>::front);
      auto const key_of_others = [&] {
        auto key = RowsOfRank<Agents>::end;
        for (auto source = sources.begin(); source != sources.end(); ++source) {
          if (source != least) key = std::min(key, source->front());
        }
        return key;
      }();
      while (row < count && least->front() < key_of_others) least->pop_into(ids, values, row++);
    }
    world_.agents.reorder(ids, values);
    world_.agents.find_again(0, count);
  }

  void add_events(EventCounts<Model> const& events) {
    for (std::size_t k = 0; k < events.size(); ++k) world_.events[k] += events[k];
  }

  static DeferredCommands<Model> read_commands(MessageReader& message) {
    DeferredCommands<Model> commands;
    commands.events = message.next<EventCounts<Model>>();
    commands.deaths = message.next_values<Id>(message.next<std::uint64_t>());
    commands.parents = message.next_values<Id>(message.next<std::uint64_t>());
    for (std::size_t k = 0; k < commands.parents.size(); ++k) {
      std::apply([&](auto&... value) { ((value = message.next<std::remove_reference_t<decltype(value)>>()), ...); },
                 commands.births.emplace_back());
    }
    return commands;
  }

  Ranks& ranks_;
  Model model_;
  World<Model>& world_;
  double cutoff_;
  double time_step_;
  std::optional<ShareOf<Model>> share_;
  std::optional<LeadingSteps<ShareOf<Model>>> steps_;
};

/// Moves a world on together with other ranks, of which this one leads: hands out the agents, has all take their steps, and gathers the
/// agents again. The bits are those of one process, the order of the rows and the names of the newborn included.
/// Errors: RunFailure for what the model throws, and as ModelEngine::advance().
template <class Model>
void advance_on_ranks(Ranks& ranks, Model const& model, std::uint64_t threads, World<Model>& world, Counters& counters,
                      StopCondition const& stop_condition) {
  if (stop_condition.is_reached(world.clock, counters.pair_collisions)) return;
  require_good_step(world.clock.step, cutoff_of(model, world), time_step_of(model, world));
  std::optional<LeadingModel<Model>> leading;
  do_or_abandon(ranks, [&] { leading.emplace(ranks, model, threads, world, counters).run(stop_condition); });
  leading->require_good_end();
}

/// What another rank sends after its agents.
template <class Model>
Ranks::Bytes last_message(Ranks const& ranks, ShareOf<Model> const& share) {
  MessageWriter message;
  message.add(ranks.traffic());
  message.add(share.events());
  DeferredCommands<Model> all;
  for (DeferredCommands<Model> const& part : share.commands()) all.append(part);
  message.add(all.events);
  message.add(std::uint64_t{all.deaths.size()});
  message.add_all(std::span<Id const>(all.deaths));
  message.add(std::uint64_t{all.parents.size()});
  message.add_all(std::span<Id const>(all.parents));
  for (auto const& newborn : all.births) std::apply([&](auto const&... value) { (message.add(value), ...); }, newborn);
  return message.take();
}

/// The part of every other rank in it: after TaskOfRanks::steps_of_model and the name of the model.
template <class Model>
void take_part(Ranks& ranks, Model model, MessageReader& message) {
  read_settings(message, [&]([[maybe_unused]] SettingVisitor& visitor) {
    if constexpr (requires { model.describe(visitor); }) model.describe(visitor);
  });
  auto const order = message.next<ShareOrder>();
  std::vector<Tiling::Rectangle> division = message.rest<Tiling::Rectangle>();
  LargeArray<Id> ids;
  typename World<Model>::Agents::AllValues values;
  for (std::uint64_t count = 1; count > 0;) {
    Ranks::Bytes const bytes = ranks.receive(0);
    MessageReader agents(bytes);
    count = agents.next<std::uint64_t>();
    append_agents(agents, count, ids, values);
  }
  ShareOf<Model> share(ranks, model, order, std::move(division), std::move(ids), std::move(values));
  bool const does_step_count = follow_steps(ranks, share);
  share.send_agents(does_step_count, [&](Ranks::Bytes agents) { ranks.send(0, std::move(agents)); });
  ranks.send(0, last_message<Model>(ranks, share));
}

}  // namespace gridlock
