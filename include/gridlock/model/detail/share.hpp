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
#include "gridlock/model/detail/cells_of_step.hpp"
#include "gridlock/model/detail/id_set.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "gridlock/parallel/detail/domain.hpp"
#include "gridlock/parallel/detail/migration.hpp"
#include "gridlock/parallel/detail/steps_together.hpp"

namespace gridlock {

/// The data of a run that processes share, besides its agents.
struct SharedRun {
  Box box;
  std::uint64_t seed;
  Clock clock;
  double cutoff, time_step;
  std::uint64_t threads;
  std::size_t agents;  ///< number of agents of all processes
};

/// Returns the Ids of the newborns of a step, the same as in a run of one process. Takes the Ids of the dead in order,
/// and the number of births. Only the root has this function, since it alone knows the free Ids.
using NameBirths = std::function<std::vector<Id>(std::span<Id const> deaths, std::size_t births)>;

/// The agents of one process in the steps of a model: its own agents, and copies of agents of other processes in the
/// rim around them. Between two steps it gives Ids to newborns, removes the dead, and exchanges agents with other
/// processes; the subclasses take the turns.
template <class Model>
class AgentsOfShare {
 public:
  using Agents = typename World<Model>::Agents;
  using AllValues = typename Agents::AllValues;

  /// Returns the failure of a turn of this process, if any.
  [[nodiscard]] std::optional<FailedTurn> const& failure() const { return failure_; }
  /// Returns the number of agents of all processes after the steps that have taken effect.
  [[nodiscard]] std::size_t population() const { return population_; }
  /// Returns the events that agents of this process counted in the steps that have taken effect.
  [[nodiscard]] EventCounts<Model> const& events() const { return events_; }
  /// Returns the counters of this process for each step since the last call; empty if turns of the model keep no
  /// counters.
  [[nodiscard]] std::vector<CountersOfStep> take_counters() { return std::exchange(counters_, {}); }

 protected:
  using Rows = std::vector<std::uint32_t>;

  /// The first part of the message that a process sends to all others after its turns.
  struct TellHead {
    std::uint64_t has_failed = 0;
    std::uint64_t deaths = 0;
    std::uint64_t births = 0;
  };
  /// The contents of the messages of all processes.
  struct Told {
    std::vector<Id> deaths;
    std::vector<Id> parents;              ///< the parent of each birth, process by process
    std::size_t first_own_parent = 0;     ///< index in `parents` of the first birth of this process
    std::vector<std::uint64_t> far_from;  ///< processes that send agents to this one without being its neighbours
    bool has_failure = false;
  };

  AgentsOfShare(Domain&& domain, Model const& model, SharedRun const& run, LargeArray<Id>&& ids, AllValues&& values,
                NameBirths name_births)
      : domain_(std::move(domain)),
        processes_(domain_.processes()),
        model_(model),
        cutoff_(run.cutoff),
        time_step_(run.time_step),
        thread_pool_(run.threads),
        name_births_(std::move(name_births)),
        world_{.box = run.box, .agents = {}, .clock = run.clock, .seed = run.seed},
        population_(run.agents),
        order_(thread_pool_),
        ids_(std::move(ids)),
        migration_(domain_) {
    order_.next() = std::move(values);
    for (std::uint32_t row = 0; row < ids_.size(); ++row) address(row);
    migration_.exchange(domain_, {}, ids_, order_.next());
  }
  ~AgentsOfShare() = default;
  AgentsOfShare(AgentsOfShare const&) = delete;
  AgentsOfShare& operator=(AgentsOfShare const&) = delete;

  static Vector place(AllValues const& values, std::size_t row) {
    return {values.template values<X>()[row], values.template values<Y>()[row]};
  }
  Neighbourhood<Model> neighbourhood(DeferredCommands<Model>& commands) {
    return {
        .world = world_, .commands = commands, .cutoff = cutoff_, .time_step = time_step_, .population = population_};
  }

  /// The deaths and births that agents of this process have requested in their turns.
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

  /// Adds rows for the newborns, whose Ids are not known yet.
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

  void address(std::uint32_t row) { migration_.address(domain_, row, place(order_.next(), row)); }

  /// Sends deaths, births and failures of this process to all processes, and returns those of all.
  Told tell_all(std::vector<Id> const& deaths, std::vector<Id> const& parents) {
    MessageWriter own;
    own.add(TellHead{.has_failed = failure_ ? std::uint64_t{1} : 0, .deaths = deaths.size(), .births = parents.size()});
    own.add_all(std::span<Id const>(deaths));
    own.add_all(std::span<Id const>(parents));
    if (!failure_) own.add_all(migration_.find_far(domain_));
    Told told;
    std::vector<Message> const of_all = all_gather(processes_, own.take());
    for (std::size_t process = 0; process < of_all.size(); ++process) {
      MessageReader message(of_all[process]);
      auto const head = message.next<TellHead>();
      told.has_failure = told.has_failure || head.has_failed != 0;
      std::ranges::copy(message.next_values<Id>(head.deaths), std::back_inserter(told.deaths));
      if (process == processes_.rank()) told.first_own_parent = told.parents.size();
      std::ranges::copy(message.next_values<Id>(head.births), std::back_inserter(told.parents));
      std::vector<std::uint64_t> const far = message.rest<std::uint64_t>();
      if (std::ranges::find(far, processes_.rank()) != far.end()) told.far_from.push_back(process);
    }
    return told;
  }

  /// Gives Ids to the newborns of all processes in the order of the parents' Ids, births of one parent in the order of
  /// its calls.
  void name_births(Told const& told, IdSet const& dead, std::size_t first_newborn) {
    std::vector<Id> names;
    if (name_births_) names = name_births_(dead.sorted(), told.parents.size());
    if (told.parents.empty()) return;
    names = MessageReader(broadcast(processes_, message_of_all(std::span<Id const>(names)))).rest<Id>();
    std::size_t const own = ids_.size() - first_newborn;
    std::size_t next = 0;
    for (std::uint32_t const birth : rows_in_order(told.parents)) {
      Id const name = names[next++];
      if (birth >= told.first_own_parent && birth < told.first_own_parent + own) {
        ids_[first_newborn + birth - told.first_own_parent] = name;
      }
    }
  }

  /// Applies the births and deaths of the turns of the first `agents` rows, in all processes. Returns false if a turn
  /// of any process has failed. find_movers() finds the rows, newborns included, that must be sent to other processes
  /// or dropped. divide_anew(dead) may divide the agents anew before they are sent, and returns whether it did.
  template <class FindMovers, class DivideAnew>
  bool let_turns_take_effect(std::size_t agents, FindMovers find_movers, DivideAnew divide_anew) {
    Asked asked;
    if (!failure_) {
      asked = this->asked();
      add_births();
      find_movers();
    }
    Told const told = tell_all(asked.deaths, asked.parents);
    if (told.has_failure) return false;
    IdSet const dead(told.deaths);
    population_ = population_ + told.parents.size() - dead.sorted().size();
    name_births(told, dead, agents);
    bool const is_divided_anew = divide_anew(dead);
    if (is_divided_anew) find_movers();
    if (!dead.sorted().empty())
      migration_.drop_dead(agents, [&](std::uint32_t row) { return dead.contains(ids_[row]); });
    forget_commands();
    if (is_divided_anew) {
      migration_.exchange_with_all(domain_, ids_, order_.next());
    } else {
      migration_.exchange(domain_, told.far_from, ids_, order_.next());
    }
    ++world_.clock.step;
    world_.clock.time += time_step_;
    return true;
  }

  /// Moves the agents of this process into empty arrays: with their values after complete_step() if the last step
  /// counts, else with their values before it.
  template <class CompleteStep>
  void take_own_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values, CompleteStep complete_step) {
    if (does_step_count && has_turns_) complete_step();
    has_turns_ = false;
    world_.agents.become(ids, values);
    std::size_t own = 0;
    for (std::size_t row = 0; row < ids.size(); ++row) {
      if (!domain_.is_own(place(values, row))) continue;
      ids[own] = ids[row];
      values.copy(own++, values, row);
    }
    ids.resize(own);
    values.resize(own);
  }

  Domain domain_;
  Communicator& processes_;
  Model model_;
  double cutoff_;
  double time_step_;
  ThreadPool thread_pool_;
  NameBirths name_births_;  ///< in the root only
  World<Model> world_;      ///< has the agents of this process and of its rim; index_of() does not work
  std::size_t population_;  ///< number of agents of all processes
  AgentsInCellOrder<Model> order_;
  std::vector<DeferredCommands<Model>> commands_;
  EventCounts<Model> events_{};
  std::vector<CountersOfStep> counters_;  ///< for each step since take_counters()
  std::optional<FailedTurn> failure_;
  bool has_turns_ = false;  ///< turns were taken whose births and deaths have not taken effect yet
  LargeArray<Id> ids_;      ///< the Ids of the rows of order_.next(), from the turns until the next sort
  Migration<Agents> migration_;
};

/// The part of one process in the steps of a synchronous model: the agents of its rectangle of the box, and copies of
/// the agents of other processes within the cutoff of it, the rim.
///
/// A step: all own agents take their turns. All processes exchange the Ids of the dead and of parents of newborns, and
/// the root gives Ids to the newborns. Then each process sends its neighbours the agents that now belong to them or to
/// their rim. Rows are sorted by the cells of the whole box, so that neighbours are visited in the same order as in a
/// run of one process.
///
/// All processes construct it and call take_step() together. The bits are those of a run of one process.
template <class Model>
class ModelShare final : public AgentsOfShare<Model> {
  using Base = AgentsOfShare<Model>;
  using typename Base::Rows;

 public:
  using typename Base::Agents;
  using typename Base::AllValues;

  /// `ids` and `values` belong to the agents in the rectangle of this process.
  ModelShare(Domain&& domain, Model const& model, SharedRun const& run, LargeArray<Id>&& ids, AllValues&& values,
             NameBirths name_births = {})
      : Base(std::move(domain), model, run, std::move(ids), std::move(values), std::move(name_births)) {
    sort();
  }

  /// Takes one step. Returns false if a turn of the last step has failed: then that step does not count.
  bool take_step() {
    if (has_turns_ && !complete_step()) return false;
    take_turns();
    return true;
  }

  /// Completes the last step if it counts, and moves the agents of this process into empty arrays. All processes call
  /// it once, at the end.
  void take_agents(bool does_step_count, LargeArray<Id>& ids, AllValues& values) {
    Base::take_own_agents(does_step_count, ids, values, [this] { complete_step(); });
  }

 private:
  using Base::commands_;
  using Base::cutoff_;
  using Base::domain_;
  using Base::failure_;
  using Base::has_turns_;
  using Base::ids_;
  using Base::migration_;
  using Base::model_;
  using Base::order_;
  using Base::place;
  using Base::population_;
  using Base::processes_;
  using Base::world_;

  /// The rows found in the turns of a band that other processes own or need.
  struct Band {
    Rows of_others;  ///< rows of agents in the rim, which other processes own
    Rows at_border;  ///< rows of own agents that have left, or that others need in their rim
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
                           [](std::size_t /*row*/) { return true; },
                           [&](Neighbourhood<Model>& around, std::size_t row, std::size_t band) {
                             take_turn(around, static_cast<std::uint32_t>(row), bands_[band]);
                           });
    } catch (FailedTurn const& failed) {
      failure_ = failed;
    }
    std::uint64_t turns = 0;
    for (Band const& band : bands_) turns += band.turns;
    processes_.note_turns(turns);
  }

  void take_turn(Neighbourhood<Model>& around, std::uint32_t row, Band& band) {
    Vector const p = place(world_.agents.values(), row);
    // Most agents are inside, and is_inside() is cheaper than is_own().
    if (!domain_.is_inside(p) && !domain_.is_own(p)) {
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
    if (!domain_.is_inside(place(order_.next(), row))) band.at_border.push_back(row);
  }

  Neighbourhood<Model> neighbourhood(DeferredCommands<Model>& commands) {
    Neighbourhood<Model> around = Base::neighbourhood(commands);
    around.next = &order_.next();
    return around;
  }

  /// Applies the births and deaths of the last turns, in all processes. Returns false if a turn of any process has
  /// failed.
  bool complete_step() {
    ids_.assign(world_.agents.ids().begin(), world_.agents.ids().end());
    auto const keep_division = [](IdSet const& /*dead*/) { return false; };
    if (!this->let_turns_take_effect(
            world_.agents.size(), [this] { find_movers(); }, keep_division))
      return false;
    sort();
    return true;
  }

  /// Finds the rows to be dropped, and the rows to be sent to each process.
  void find_movers() {
    migration_.begin();
    for (Band const& band : bands_) {
      for (std::uint32_t const row : band.of_others) migration_.drop(row);
      for (std::uint32_t const row : band.at_border) this->address(row);
    }
    for (auto row = static_cast<std::uint32_t>(world_.agents.size()); row < ids_.size(); ++row) this->address(row);
  }

  /// Sorts the rows by their cells; all processes choose the same cells.
  void sort() {
    CellsOfStep const cells = cells_of_step(world_.box, cutoff_, population_);
    AllValues const& next = order_.next();
    bool const is_finer = cells.finer && is_crowd(domain_, cells.layout, next.template values<X>(),
                                                  next.template values<Y>(), population_);
    CellLayout const& layout = is_finer ? *cells.finer : cells.layout;
    order_.sort_window(world_.agents, ids_, layout, domain_.window_in(layout),
                       is_finer ? StoredCells::Which::occupied : StoredCells::Which::all);
  }

  std::vector<Band> bands_;
};

}  // namespace gridlock
