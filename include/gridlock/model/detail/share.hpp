#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/detail/counters_of_step.hpp"
#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/model/detail/agents_in_cell_order.hpp"
#include "gridlock/model/detail/agents_message.hpp"
#include "gridlock/model/detail/rank_division.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"

namespace gridlock {

/// What a rank must know of a run besides its agents.
struct ShareOrder {
  double width, height;
  std::uint64_t is_periodic;
  std::uint64_t seed;
  Clock clock;
  double cutoff, time_step;
  std::uint64_t threads;
  std::uint64_t agents;         ///< of all ranks
  std::uint64_t columns, rows;  ///< of the cells of the division

  void set_cells(CellLayout const& cells) {
    columns = static_cast<std::uint64_t>(cells.columns());
    rows = static_cast<std::uint64_t>(cells.rows());
  }
  [[nodiscard]] Box box() const { return {width, height, is_periodic != 0 ? Edge::periodic : Edge::wall}; }
  [[nodiscard]] CellLayout cells() const { return {box(), columns, rows}; }
};

/// Gives names to newborn agents, as one process does: takes the deaths of a step in the order of the Ids and the
/// number of births. Only the leader knows which names are free.
using NameBirths = std::function<std::vector<Id>(std::span<Id const> deaths, std::size_t births)>;

/// The agents that one rank has in the steps of a model, and the rim around them that others own; and what is the same
/// for all schedules between two steps: who is born gets a name, who is dead goes, and each rank gets the agents that
/// it has to know.
template <class Model>
class AgentsOfShare {
 public:
  using Agents = typename World<Model>::Agents;
  using AllValues = typename Agents::AllValues;

  /// Of a turn of this rank.
  [[nodiscard]] std::optional<FailedTurn> const& failure() const { return failure_; }
  /// How many agents all ranks have, as far as steps have taken effect.
  [[nodiscard]] std::size_t population() const { return population_; }
  /// What happened in the steps that have taken effect.
  [[nodiscard]] EventCounts<Model> const& events() const { return events_; }
  /// What the turns of this rank have counted in each step since the last call; nothing where they keep no counters.
  [[nodiscard]] std::vector<CountersOfStep> take_counters() { return std::exchange(counters_, {}); }

 protected:
  using Rows = std::vector<std::uint32_t>;

  /// What a rank tells all others after its turns.
  struct TellHead {
    std::uint64_t has_failed = 0;
    std::uint64_t deaths = 0;
    std::uint64_t births = 0;
  };
  /// What all have told.
  struct Told {
    std::vector<Id> deaths;
    std::vector<Id> parents;             ///< of all births, rank by rank
    std::size_t first_own_parent = 0;    ///< among them
    std::vector<std::size_t> also_from;  ///< ranks that are no neighbours and send agents
    bool has_failure = false;
  };

  AgentsOfShare(Communicator& ranks, Model const& model, ShareOrder const& order, RankDivision division,
                LargeArray<Id>&& ids, AllValues&& values, NameBirths name_births)
      : ranks_(ranks),
        model_(model),
        cutoff_(order.cutoff),
        time_step_(order.time_step),
        thread_pool_(order.threads),
        division_(std::move(division)),
        name_births_(std::move(name_births)),
        world_{.box = order.box(), .agents = {}, .clock = order.clock, .seed = order.seed},
        population_(order.agents),
        order_(thread_pool_),
        ids_(std::move(ids)),
        rows_to_(ranks.count()) {
    order_.next() = std::move(values);
    for (std::uint32_t row = 0; row < ids_.size(); ++row) address(row);
    exchange({});
  }
  ~AgentsOfShare() = default;
  AgentsOfShare(AgentsOfShare const&) = delete;
  AgentsOfShare& operator=(AgentsOfShare const&) = delete;

  static bool is_among(std::vector<std::size_t> const& ranks, std::size_t rank) {
    return std::ranges::find(ranks, rank) != ranks.end();
  }
  static Vector place(AllValues const& values, std::size_t row) {
    return {values.template values<X>()[row], values.template values<Y>()[row]};
  }
  Neighbourhood<Model> neighbourhood(DeferredCommands<Model>& commands) {
    return {
        .world = world_, .commands = commands, .cutoff = cutoff_, .time_step = time_step_, .population = population_};
  }

  /// What all agents of this rank have asked for in their turns.
  struct Asked {
    std::vector<Id> deaths;
    std::vector<Id> parents;
  };
  [[nodiscard]] Asked asked() const {
    Asked asked;
    for (DeferredCommands<Model> const& commands : commands_) {
      asked.parents.insert(asked.parents.end(), commands.parents.begin(), commands.parents.end());
      asked.deaths.insert(asked.deaths.end(), commands.deaths.begin(), commands.deaths.end());
    }
    return asked;
  }
  void forget_commands() {
    for (DeferredCommands<Model>& commands : commands_) {
      for (std::size_t k = 0; k < events_.size(); ++k) events_[k] += commands.events[k];
      commands.clear();
    }
  }

  /// Adds rows for the newborn, who have no names yet.
  void add_births() {
    AllValues& next = order_.next();
    for (DeferredCommands<Model> const& commands : commands_) {
      for (auto const& newborn : commands.births) {
        next.resize(ids_.size() + 1);
        next.put(ids_.size(), newborn);
        ids_.push_back(0);
      }
    }
  }

  /// Notes which ranks have to know of a row, and whether it stays here.
  void address(std::uint32_t row) {
    Vector const p = place(order_.next(), row);
    if (division_.is_inside(p)) return;
    auto const address_to = [&](std::size_t rank) {
      if (rank != ranks_.rank() && division_.is_seen_by(rank, p)) rows_to_[rank].push_back(row);
    };
    if (division_.is_own(p)) {
      for (std::size_t const rank : division_.neighbours()) address_to(rank);
      return;
    }
    for (std::size_t rank = 0; rank < ranks_.count(); ++rank) address_to(rank);
    // A newborn or an arrival of the rim of this rank stays to be seen.
    if (!division_.is_seen_by(ranks_.rank(), p)) dropped_.push_back(row);
  }

  /// Tells all ranks what concerns all.
  Told tell_all(std::vector<Id> const& deaths, std::vector<Id> const& parents) {
    also_to_.clear();
    MessageWriter own;
    own.add(TellHead{.has_failed = failure_ ? std::uint64_t{1} : 0, .deaths = deaths.size(), .births = parents.size()});
    own.add_all(std::span<Id const>(deaths));
    own.add_all(std::span<Id const>(parents));
    if (!failure_) {
      for (std::size_t rank = 0; rank < ranks_.count(); ++rank) {
        if (rows_to_[rank].empty() || division_.is_neighbour(rank)) continue;
        own.add(std::uint64_t{rank});
        also_to_.push_back(rank);
      }
    }
    Told told;
    std::vector<Message> const of_all = all_gather(ranks_, own.take());
    for (std::size_t rank = 0; rank < of_all.size(); ++rank) {
      MessageReader message(of_all[rank]);
      auto const head = message.next<TellHead>();
      told.has_failure = told.has_failure || head.has_failed != 0;
      std::ranges::copy(message.next_values<Id>(head.deaths), std::back_inserter(told.deaths));
      if (rank == ranks_.rank()) told.first_own_parent = told.parents.size();
      std::ranges::copy(message.next_values<Id>(head.births), std::back_inserter(told.parents));
      std::vector<std::uint64_t> const sends_to = message.rest<std::uint64_t>();
      if (std::ranges::find(sends_to, ranks_.rank()) != sends_to.end()) told.also_from.push_back(rank);
    }
    return told;
  }

  /// The newborn of all ranks get their names in the order of their parents' Ids, those of one parent as it asked for
  /// them.
  void name_births(Told const& told, IdSet const& dead, std::size_t first_newborn) {
    std::vector<Id> names;
    if (name_births_) names = name_births_(dead.sorted(), told.parents.size());
    if (told.parents.empty()) return;
    names = MessageReader(broadcast(ranks_, message_of_all(std::span<Id const>(names)))).rest<Id>();
    std::size_t const own = ids_.size() - first_newborn;
    std::size_t next = 0;
    for (std::uint32_t const birth : rows_in_order(told.parents)) {
      Id const name = names[next++];
      if (birth >= told.first_own_parent && birth < told.first_own_parent + own) {
        ids_[first_newborn + birth - told.first_own_parent] = name;
      }
    }
  }

  /// Of the rows of this rank as the step began.
  void drop_dead(IdSet const& dead, std::size_t rows) {
    if (dead.sorted().empty()) return;
    for (std::uint32_t row = 0; row < rows; ++row) {
      if (dead.contains(ids_[row])) dropped_.push_back(row);
    }
    for (Rows& addressed : rows_to_) {
      std::erase_if(addressed, [&](std::uint32_t row) { return row < rows && dead.contains(ids_[row]); });
    }
  }

  /// Sends rows to those who have to know them, and takes what has come in the place of those that do not stay.
  void exchange(std::vector<std::size_t> const& also_from) {
    ArrivedAgents<Agents> arrived;
    // One round for each distance between ranks: nobody waits to send before what came earlier has been received.
    std::size_t const count = ranks_.count();
    for (std::size_t distance = 1; distance < count; ++distance) {
      std::size_t const to = (ranks_.rank() + distance) % count;
      std::size_t const from = (ranks_.rank() + count - distance) % count;
      if (division_.is_neighbour(to) || is_among(also_to_, to)) {
        MessageWriter message;
        message.add(std::uint64_t{rows_to_[to].size()});
        add_agents(message, ids_.data(), order_.next(), rows_to_[to]);
        ranks_.send(to, message.take());
      }
      if (division_.is_neighbour(from) || is_among(also_from, from)) {
        arrived.add(ranks_.receive(from));
      }
    }
    std::ranges::sort(dropped_);
    dropped_.erase(std::unique(dropped_.begin(), dropped_.end()), dropped_.end());
    arrived.put_into(ids_, order_.next(), dropped_);
    dropped_.clear();
  }

  /// Lets what was asked for in the turns of the first `agents` rows take effect, on all ranks. False where a turn of
  /// any rank has failed. find_movers() finds out which rows, the newborn behind those included, do not stay here, and
  /// who has to be told of which; divide_anew(dead, told) may divide the agents anew before they travel.
  template <class FindMovers, class DivideAnew>
  bool let_turns_take_effect(std::size_t agents, FindMovers find_movers, DivideAnew divide_anew) {
    Asked asked;
    if (!failure_) {
      asked = this->asked();
      add_births();
      find_movers();
    }
    Told told = tell_all(asked.deaths, asked.parents);
    if (told.has_failure) return false;
    IdSet const dead(told.deaths);
    population_ = population_ + told.parents.size() - dead.sorted().size();
    name_births(told, dead, agents);
    divide_anew(dead, told);
    drop_dead(dead, agents);
    forget_commands();
    exchange(told.also_from);
    ++world_.clock.step;
    world_.clock.time += time_step_;
    return true;
  }

  /// Moves the agents of this rank into empty arrays: after the last step has taken effect, by complete_step(), or as
  /// they were before it.
  template <class CompleteStep>
  void take_own_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values, CompleteStep complete_step) {
    if (does_step_count && has_turns_) complete_step();
    has_turns_ = false;
    world_.agents.become(ids, values);
    std::size_t own = 0;
    for (std::size_t row = 0; row < ids.size(); ++row) {
      if (!division_.is_own(place(values, row))) continue;
      ids[own] = ids[row];
      values.copy(own++, values, row);
    }
    ids.resize(own);
    values.resize(own);
  }

  Communicator& ranks_;
  Model model_;
  double cutoff_;
  double time_step_;
  ThreadPool thread_pool_;
  RankDivision division_;
  NameBirths name_births_;  ///< of the leader
  World<Model> world_;      ///< with the agents of this rank and of its rim, who cannot be found by their Ids
  std::size_t population_;  ///< of all ranks
  AgentsInCellOrder<Model> order_;
  std::vector<DeferredCommands<Model>> commands_;
  EventCounts<Model> events_{};
  std::vector<CountersOfStep> counters_;  ///< of each step that nobody has asked for yet
  std::optional<FailedTurn> failure_;
  bool has_turns_ = false;  ///< what they ask for has not taken effect yet
  // Between the turns and the next order of the rows:
  LargeArray<Id> ids_;                ///< of the rows of order_.next()
  std::vector<Rows> rows_to_;         ///< what each rank has to know
  std::vector<std::size_t> also_to_;  ///< ranks that are no neighbours and have to know some
  Rows dropped_;                      ///< rows of the dead, of those who have left, and of the rim of before
};

/// The share that one rank has in the steps of a synchronous model: the agents of its rectangle of the box, and those
/// within the cutoff of it that others own.
///
///     ┌ ─ ─ ─ ─ ─ ─ ─ ┐     A step: all own agents take their turns. Then all ranks tell each other who has died and who has
///       ┌───────────┐       had a child, the leader names the children, and each rank sends to its neighbours the agents that they
///     │ │ rectangle │ │     own from now on or have in their rim. The rows are put into the order of the cells of the whole box, so
///       └───────────┘       that all neighbours are visited in the order of one process.
///     └ ─ ─ ─ rim ─ ─ ┘
///
/// All ranks construct it and call take_step() together. The bits are those of one process.
template <class Model>
class ModelShare final : public AgentsOfShare<Model> {
  using Base = AgentsOfShare<Model>;
  using typename Base::Rows;
  using typename Base::Told;

 public:
  using typename Base::Agents;
  using typename Base::AllValues;

  /// `ids` and `values` are those of the agents in the rectangle of this rank.
  ModelShare(Communicator& ranks, Model const& model, ShareOrder const& order, std::vector<Tiling::Rectangle> division,
             LargeArray<Id>&& ids, AllValues&& values, NameBirths name_births = {})
      : Base(ranks, model, order, division_of(order, std::move(division), ranks.rank()), std::move(ids),
             std::move(values), std::move(name_births)) {
    sort();
  }

  static RankDivision division_of(ShareOrder const& order, std::vector<Tiling::Rectangle> division, std::size_t rank) {
    CellLayout const cells = order.cells();
    return {cells, std::move(division), rim_of(cells, order.cutoff), rank};
  }

  /// False where a turn has failed: then the step does not count.
  bool take_step() {
    if (has_turns_ && !complete_step()) return false;
    take_turns();
    return true;
  }

  /// Lets the last step take effect, unless it does not count, and moves the agents of this rank into empty arrays. All
  /// ranks call it, once, at the end.
  void take_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values) {
    Base::take_own_agents(does_step_count, ids, values, [this] { complete_step(); });
  }

 private:
  using Base::commands_;
  using Base::cutoff_;
  using Base::division_;
  using Base::dropped_;
  using Base::failure_;
  using Base::has_turns_;
  using Base::ids_;
  using Base::model_;
  using Base::order_;
  using Base::place;
  using Base::population_;
  using Base::ranks_;
  using Base::rows_to_;
  using Base::world_;

  /// What the turns of a band have found out besides the values.
  struct Band {
    Rows of_others;  ///< rows of the rim
    Rows at_border;  ///< rows of own agents that others have to know, or that have left
    std::uint64_t turns = 0;
  };

  [[nodiscard]] std::uint32_t cell_of(std::size_t row) const {
    return static_cast<std::uint32_t>(order_.layout().cell_of(place(world_.agents.values(), row)));
  }

  void take_turns() {
    order_.begin_turns(world_.agents.size());
    commands_.resize(order_.bands());
    bands_.assign(order_.bands(), {});
    has_turns_ = true;
    try {
      order_.for_each_turn([&](std::size_t band) { return neighbourhood(commands_[band]); },
                           [&](Neighbourhood<Model>& around, std::size_t row, std::size_t band) {
                             take_turn(around, static_cast<std::uint32_t>(row), bands_[band]);
                           });
    } catch (FailedTurn const& failed) {
      failure_ = failed;
    }
    std::uint64_t turns = 0;
    for (Band const& band : bands_) turns += band.turns;
    ranks_.note_turns(turns);
  }

  void take_turn(Neighbourhood<Model>& around, std::uint32_t row, Band& band) {
    Vector const p = place(world_.agents.values(), row);
    // Most are, and the first question is the cheaper one.
    if (!division_.is_inside(p) && !division_.is_own(p)) {
      band.of_others.push_back(row);
      return;
    }
    order_.copy_present(world_.agents, row);
    try {
      Turn<Model> turn(around, row);
      model_.turn(turn);
    } catch (std::exception const& error) {
      throw FailedTurn{.cell = cell_of(row), .agent = world_.agents.ids()[row], .reason = error.what()};
    }
    ++band.turns;
    if (!division_.is_inside(place(order_.next(), row))) band.at_border.push_back(row);
  }

  Neighbourhood<Model> neighbourhood(DeferredCommands<Model>& commands) {
    Neighbourhood<Model> around = Base::neighbourhood(commands);
    around.next = &order_.next();
    return around;
  }

  /// Lets what was asked for in the turns take effect, on all ranks. False where a turn of any rank has failed.
  bool complete_step() {
    ids_.assign(world_.agents.ids().begin(), world_.agents.ids().end());
    auto const keep_division = [](IdSet const& /*dead*/, Told const& /*told*/) {};
    if (!this->let_turns_take_effect(
            world_.agents.size(), [this] { find_movers(); }, keep_division))
      return false;
    sort();
    return true;
  }

  /// Finds out which rows do not stay here, and who has to be told of which.
  void find_movers() {
    for (Rows& rows : rows_to_) rows.clear();
    dropped_.clear();
    for (Band const& band : bands_) {
      dropped_.insert(dropped_.end(), band.of_others.begin(), band.of_others.end());
      for (std::uint32_t const row : band.at_border) this->address(row);
    }
    for (auto row = static_cast<std::uint32_t>(world_.agents.size()); row < ids_.size(); ++row) this->address(row);
  }

  /// Puts the rows in the order of the cells, which all ranks choose alike.
  void sort() {
    CellsOfStep const cells = cells_of_step(world_.box, cutoff_, population_);
    bool const is_finer = cells.finer && is_crowd_of_all(cells.layout);
    CellLayout const& layout = is_finer ? *cells.finer : cells.layout;
    order_.sort_window(world_.agents, ids_, layout, division_.window_of(layout),
                       is_finer ? StoredCells::Which::occupied : StoredCells::Which::all);
  }

  [[nodiscard]] bool is_crowd_of_all(CellLayout const& layout) {
    AllValues const& next = order_.next();
    CellCounts const counts(division_, layout, next.template values<X>(), next.template values<Y>(),
                            [&](std::size_t row) { return division_.is_own(place(next, row)); });
    MessageWriter own;
    own.add(counts.pairs());
    own.add_all(counts.shared());
    std::uint64_t pairs = 0;
    std::vector<CellCounts::SharedCell> shared;
    for (Message const& bytes : all_gather(ranks_, own.take())) {
      MessageReader message(bytes);
      pairs += message.next<std::uint64_t>();
      std::ranges::copy(message.rest<CellCounts::SharedCell>(), std::back_inserter(shared));
    }
    return is_crowd(pairs + CellCounts::pairs_in(std::move(shared)), population_);
  }

  std::vector<Band> bands_;
};

}  // namespace gridlock
