#pragma once

/// \file
/// A turn: the functions with which an agent reads its neighbours and changes itself in a step.
///
/// ```cpp
/// struct Walkers {
///   static constexpr Schedule schedule = Schedule::sequential;
///   using Agents = Population<X, Y>;
///   void turn(Turn<Walkers>& self) const {
///     RandomStream random = self.random();
///     self.move_by(0.01 * random.in_unit_disk());
///     self.for_each_neighbour(0.1, [](Neighbour<Walkers> const& other) { other.kill(); });
///   }
/// };
/// ```

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/row_block.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/deferred_commands.hpp"
#include "gridlock/model/detail/motion.hpp"
#include "gridlock/model/detail/verify.hpp"
#include "gridlock/model/networks.hpp"

namespace gridlock {

/// Returns whether the turns of a model update counters of collisions and impulses. Synchronous models cannot: their
/// turns on several threads have no fixed order in which to sum floating-point numbers.
template <class Model>
consteval bool keeps_counters() {
  if constexpr (requires { Model::keeps_counters; }) {
    static_assert(
        !Model::keeps_counters || Model::schedule == Schedule::sequential || Model::schedule == Schedule::tiled,
        "counters are for models that are sequential or tiled");
    return Model::keeps_counters;
  } else {
    return false;
  }
}

/// A neighbour of the agent whose turn it is, or of another point of its search.
template <class Model>
class Neighbour {
 public:
  using Agents = typename World<Model>::Agents;

  Neighbour(World<Model>& world, DeferredCommands<Model>& commands, std::size_t row, Vector seen_from)
      : world_(world), commands_(commands), row_(row), seen_from_(seen_from) {}

  [[nodiscard]] Id id() const { return world_.agents.ids()[row_]; }
  /// Returns a value of the neighbour: its value before the step in a synchronous model, its present value in all
  /// others.
  template <class Column>
  [[nodiscard]] typename Column::type get() const {
    return world_.agents.template column<Column>()[row_];
  }
  [[nodiscard]] Vector position() const { return {get<X>(), get<Y>()}; }
  /// Returns the vector from the point of the search to the nearest image of the neighbour.
  [[nodiscard]] Vector separation() const { return world_.box.displacement(seen_from_, position()); }

  /// Changes a value of the neighbour. Not for synchronous models, where two agents could change it at the same time.
  template <class Column>
  void set(typename Column::type value) const requires(Model::schedule != Schedule::synchronous) {
    static_assert(!std::is_same_v<Column, X> && !std::is_same_v<Column, Y>, "only its own turn moves an agent");
    world_.agents.template column<Column>()[row_] = value;
  }
  /// Makes the neighbour die at the end of the step. Several agents may kill the same neighbour.
  void kill() const { commands_.deaths.push_back(id()); }

 private:
  World<Model>& world_;
  DeferredCommands<Model>& commands_;
  std::size_t row_;
  Vector seen_from_;
};

/// The data that the turns of all agents in a part of the world share. Models use Turn instead.
template <class Model>
struct Neighbourhood {
  World<Model>& world;
  DeferredCommands<Model>& commands;
  typename World<Model>::Agents::AllValues* next = nullptr;  ///< synchronous: the values of all agents after the step
  PackedGrid* grid = nullptr;                                ///< sequential, tiled: the present positions of all agents
  Counters* counters = nullptr;                              ///< sequential, tiled: the counters of these turns
  double cutoff = 0.0;                                       ///< the model's
  double time_step = 0.0;                                    ///< the model's
  std::size_t population = 0;                                ///< number of agents when the step began
  bool is_verified = false;                                  ///< whether searches are compared with brute force
  std::span<NeighboursOnNetwork const> on_networks = {};     ///< in the order of World::networks

  /// Synchronous: the rows of the agents in the block of cells around the agent, and whether the block touches an edge.
  RowBlock block;
  /// Tiled: whether agents of other tiles take turns at the same time, so that an agent may use only the cells next to
  /// its own.
  bool is_confined = false;
  /// Tiled, in a late turn of several processes: fetches from other processes the cells within `columns` columns and
  /// `rows` rows of the cell of `p`.
  std::function<void(Vector p, int columns, int rows)> const* get_cells = nullptr;
};

/// The turn of an agent in a step: reads its neighbours, and changes and moves itself.
///
/// In a synchronous model get() and all neighbours have the values before the step, while set() and moves write the
/// values after the step. In a sequential or tiled model set() and moves take effect at once. Births and deaths always
/// take effect at the end of the step, in an order that depends on the state alone. So do changes of fields, but in a
/// sequential model at once.
/// Errors: RunFailure, in every build, for an agent that leaves the box, a search beyond the model's cutoff, a move of
/// a local agent of a tiled model beyond the cells next to its own, and an event that is not declared.
template <class Model>
class Turn {
 public:
  using Agents = typename World<Model>::Agents;
  using Row = typename Agents::Values;  ///< one value per column

  Turn(Neighbourhood<Model>& neighbourhood, std::size_t row) : around_(neighbourhood), row_(row) {
    if constexpr (Model::schedule == Schedule::tiled) home_ = around_.grid->cell_of(row_);
  }

  [[nodiscard]] Id id() const { return world().agents.ids()[row_]; }
  [[nodiscard]] Box const& box() const { return world().box; }
  [[nodiscard]] Clock const& clock() const { return world().clock; }
  /// Return the cutoff and the time step of the model in this step.
  [[nodiscard]] double cutoff() const { return around_.cutoff; }
  [[nodiscard]] double time_step() const { return around_.time_step; }
  /// Returns the number of agents when the step began.
  [[nodiscard]] std::size_t population() const { return around_.population; }
  [[nodiscard]] Vector position() const { return {get<X>(), get<Y>()}; }

  template <class Column>
  [[nodiscard]] typename Column::type get() const {
    return world().agents.template column<Column>()[row_];
  }
  /// Return a field, and its value in the cell around a point or around position(): before the step in a synchronous or
  /// tiled model, at present in a sequential one. Beyond a periodic edge a point stands for its image.
  /// Errors: RunFailure for a point beyond a wall.
  template <class Tag>
  [[nodiscard]] Field const& field() const {
    return field_of<Tag>(world());
  }
  template <class Tag>
  [[nodiscard]] double at(Vector p) const {
    return field<Tag>().values()[cell_around(field<Tag>(), box(), p, clock().step)];
  }
  template <class Tag>
  [[nodiscard]] double at() const {
    return at<Tag>(position());
  }
  /// Add an amount to the cell around a point or around position(): at the end of the step in a synchronous or tiled
  /// model, at once in a sequential one. Errors: RunFailure for a value that is infinite or no number then.
  template <class Tag>
  void deposit(Vector p, double amount) {
    std::size_t const cell = cell_around(field<Tag>(), box(), p, clock().step);
    if constexpr (Model::schedule == Schedule::sequential) {
      deposit_now(field_of<Tag>(around_.world), cell, amount, clock().step);
    } else {
      requests<Tag>().deposits.push_back({.cell = cell, .amount = amount});
    }
  }
  template <class Tag>
  void deposit(double amount) {
    deposit<Tag>(position(), amount);
  }
  /// Takes at most `amount` from the cell around position(), and returns what was there.
  /// Errors: RunFailure unless the amount is a number from 0 on.
  template <class Tag>
  double take(double amount) requires(Model::schedule == Schedule::sequential) {
    require_amount_to_take(field<Tag>(), amount, clock().step, id());
    std::size_t const cell = field<Tag>().cell_of(box(), position());
    return take_now(field_of<Tag>(around_.world), cell, amount);
  }
  /// Takes at most `amount` from the cell around position() at the end of the step, before deposits, and adds what the
  /// agent gets to its column `Into`. Where a cell has too little for all, agents take one after the other, in an order
  /// that is drawn anew in each step. Errors: RunFailure unless the amount is a number from 0 on.
  template <class Tag, class Into>
  void take(double amount) requires(Model::schedule != Schedule::sequential) {
    static_assert(std::is_same_v<typename Into::type, double>, "a column of double takes what an agent gets");
    static_assert(!std::is_same_v<Into, X> && !std::is_same_v<Into, Y>, "what an agent gets does not move it");
    require_amount_to_take(field<Tag>(), amount, clock().step, id());
    requests<Tag>().takes.push_back({.cell = field<Tag>().cell_of(box(), position()),
                                     .amount = amount,
                                     .agent = id(),
                                     .row = static_cast<std::uint32_t>(row_),
                                     .column = static_cast<std::uint32_t>(Agents::template place_of<Into>)});
  }

  template <class Column>
  void set(typename Column::type value) {
    static_assert(!std::is_same_v<Column, X> && !std::is_same_v<Column, Y>, "move_to() and move_by() set the place");
    write<Column>(value);
  }

  /// Moves from position() by `displacement`, across periodic edges, and reflected by walls. Returns the directions in
  /// which walls reflected the move, so that the model can reflect its heading too. Updates columns ImageX and ImageY.
  /// Errors: RunFailure for a displacement that is not shorter than the sides of the box.
  Bounce move_by(Vector displacement) {
    // Most moves end inside the box; only the others need the check of their length.
    Vector const end = position() + displacement;
    if (!is_within_edges(end)) return move_across_edges(displacement);
    go_to(end);
    return {};
  }
  /// Moves to a point of the box. Errors: RunFailure for a point outside.
  void move_to(Vector p) {
    if (!is_inside(box(), p)) throw_outside(clock().step, id(), p, box());
    go_to(p);
  }

  /// Returns the random numbers of this agent in this step; different purposes 0, 1, 2 … give independent numbers.
  [[nodiscard]] RandomStream random(std::uint64_t purpose = 0) const {
    return {world().seed, world().clock.step, id(), purpose_of_turn(purpose)};
  }

  /// Calls visit(neighbour) for every other agent nearer than `cutoff`. Errors: RunFailure if `cutoff` is above the
  /// cutoff of the model.
  template <class Visit>
  void for_each_neighbour(double cutoff, Visit visit) const {
    Vector const p = position();
    if (!(cutoff >= 0.0 && cutoff <= around_.cutoff)) throw_far(p, cutoff);
    visit_near(p, cutoff, visit);
  }
  /// Calls visit(neighbour) for every other agent nearer to `p` than `cutoff`. In a synchronous model the whole search
  /// must lie within the cutoff of the model around the agent.
  template <class Visit>
  void for_each_neighbour(Vector p, double cutoff, Visit visit) const {
    if (!(cutoff >= 0.0 && cutoff <= around_.cutoff && is_searchable(p, cutoff))) throw_far(p, cutoff);
    visit_near(p, cutoff, visit);
  }

  /// Returns a network as it was when the step began.
  template <class Tag>
  [[nodiscard]] Network const& network() const {
    return network_of<Tag>(world());
  }
  /// Return the number of neighbours on a network, and neighbour k of them in the order of their Ids; on a directed
  /// network those that the edges of the agent lead to. Contract: k < degree().
  template <class Tag>
  [[nodiscard]] std::size_t degree() const {
    return on_network<Tag>().size();
  }
  template <class Tag>
  [[nodiscard]] Neighbour<Model> neighbour(std::size_t k) const {
    return neighbour_of(on_network<Tag>()[k].id);
  }
  /// Calls visit(neighbour, weight) for every neighbour on a network, in the order of their Ids. Cost: about 30 ns a
  /// neighbour among 100,000 agents, most of it waits for memory.
  template <class Tag, class Visit>
  void for_each_neighbour(Visit visit) const {
    for (auto const& [id, weight] : on_network<Tag>()) visit(neighbour_of(id), weight);
  }

  /// Adds an agent at the end of the step, with one value per column in the order the columns are declared.
  /// Errors: RunFailure for a point outside the box.
  template <class... Values>
  void give_birth(Values... values) {
    Row const newborn{values...};
    Vector const p = position_of<Agents>(newborn);
    if (!is_inside(box(), p)) throw_birth_outside(clock().step, id(), p, box());
    around_.commands.births.push_back(newborn);
    around_.commands.parents.push_back(id());
  }
  /// Dies at the end of the step.
  void die() { around_.commands.deaths.push_back(id()); }
  /// Counts an event of the model, see `Model::events`. Errors: RunFailure for an event that is not declared.
  void count(std::size_t event) {
    if (event >= event_names<Model>().size()) {
      throw_unknown_event(clock().step, id(), event, event_names<Model>());
    }
    ++around_.commands.events[event];
  }
  /// Counts of moves and collisions and sums of impulses, which the turns of a model with `keeps_counters` update: from
  /// them a run measures collision rates and pressures.
  [[nodiscard]] Counters& counters() requires(keeps_counters<Model>()) { return *around_.counters; }

 private:
  [[nodiscard]] World<Model> const& world() const { return around_.world; }
  template <class Tag>
  [[nodiscard]] FieldRequests& requests() {
    return around_.commands.fields[FieldsOf<Model>::template place_of<Tag>];
  }
  template <class Tag>
  [[nodiscard]] std::span<NeighboursOnNetwork::Neighbour const> on_network() const {
    static_assert(NetworksOf<Model>::template has<Tag>, "the model names each of its networks in Networks");
    return around_.on_networks[NetworksOf<Model>::template place_of<Tag>].of(id());
  }
  [[nodiscard]] Neighbour<Model> neighbour_of(Id id) const {
    return {around_.world, around_.commands, world().agents.index_of(id), position()};
  }

  template <class Column>
  void write(typename Column::type value) {
    if constexpr (Model::schedule == Schedule::synchronous) {
      around_.next->template values<Column>()[row_] = value;
    } else {
      around_.world.agents.template column<Column>()[row_] = value;
    }
  }

  [[nodiscard]] bool is_within_edges(Vector p) const {
    return p.x >= 0.0 && p.x < box().width() && p.y >= 0.0 && p.y < box().height();
  }
  [[gnu::noinline]] Bounce move_across_edges(Vector displacement) {
    if (!is_shorter_than_box(box(), displacement)) throw_long_displacement(clock().step, id(), displacement, box());
    Motion const to = motion(box(), position(), displacement);
    if constexpr (Agents::template has<ImageX>) {
      set<ImageX>(get<ImageX>() + to.crossed_x);
      set<ImageY>(get<ImageY>() + to.crossed_y);
    }
    go_to(to.end);
    return to.bounce;
  }
  void go_to(Vector p) {
    if constexpr (Model::schedule == Schedule::tiled) {
      if (around_.is_confined && !around_.grid->layout().is_in_block(home_, p)) {
        throw_far_move(clock().step, id(), position(), p);
      }
      if (around_.get_cells != nullptr) (*around_.get_cells)(p, 0, 0);
    }
    write<X>(p.x);
    write<Y>(p.y);
    if constexpr (Model::schedule != Schedule::synchronous) around_.grid->move(row_, p);
  }

  /// Returns whether a search around `p` finds all neighbours: a synchronous model searches only the cells around the
  /// agent.
  [[nodiscard]] bool is_searchable(Vector p, double cutoff) const {
    if constexpr (Model::schedule == Schedule::synchronous) {
      // The cells are wider than the cutoff by this factor, so that a search at exactly the cutoff passes despite
      // rounding.
      constexpr double rounding = 1.0 + 1e-9;
      double const room = around_.cutoff - cutoff;
      return squared_length(box().displacement(position(), p)) <= room * room * rounding;
    } else {
      return is_finite(p);
    }
  }

  [[noreturn, gnu::cold]] void throw_far(Vector p, double cutoff) const {
    throw_far_search({.step = clock().step,
                      .agent = id(),
                      .point = p,
                      .position = position(),
                      .cutoff = cutoff,
                      .declared = around_.cutoff});
  }

  template <class Visit>
  void visit_near(Vector p, double cutoff, Visit& visit) const {
    DeferredCommands<Model>& commands = around_.commands;
    std::size_t const first = commands.found_top;
    if constexpr (Model::schedule == Schedule::synchronous) {
      find_in_ranges(p, cutoff);
    } else {
      find_in_grid(p, cutoff);
    }
    if (around_.is_verified) verify(p, cutoff, first);
    // By index, since a search within visit() may reallocate the stack.
    for (std::size_t k = first; k < commands.found_top; ++k) {
      visit(Neighbour<Model>(around_.world, commands, commands.found[k], p));
    }
    commands.found_top = first;
  }

  void find_in_ranges(Vector p, double cutoff) const {
    DeferredCommands<Model>& commands = around_.commands;
    std::size_t const room = commands.found_top + around_.block.candidates + neighbour_slack;
    if (commands.found.size() < room) commands.found.resize(2 * room);
    commands.found_top += find_neighbours({.x = world().agents.template column<X>().data(),
                                           .y = world().agents.template column<Y>().data(),
                                           .size = world().agents.size(),
                                           .p = p,
                                           .squared_cutoff = cutoff * cutoff,
                                           .left_out = row_,
                                           .box = around_.block.is_at_edge ? &world().box : nullptr},
                                          around_.block.ranges(), commands.found.data() + commands.found_top);
  }

  void find_in_grid(Vector p, double cutoff) const {
    DeferredCommands<Model>& commands = around_.commands;
    commands.found.resize(commands.found_top);
    auto const consider = [&](std::size_t row) {
      Vector const separation = world().box.displacement(
          p, {world().agents.template column<X>()[row], world().agents.template column<Y>()[row]});
      if (row != row_ && squared_length(separation) < cutoff * cutoff) {
        commands.found.push_back(static_cast<std::uint32_t>(row));
      }
    };
    if (around_.is_confined) {
      around_.grid->for_each_in_block(home_, 1, 1, consider);
    } else if (around_.get_cells != nullptr) {
      CellLayout const& layout = around_.grid->layout();
      int const columns = layout.columns_within(cutoff);
      int const rows = layout.rows_within(cutoff);
      (*around_.get_cells)(p, columns, rows);
      around_.grid->for_each_in_block(layout.cell_of(p), columns, rows, consider);
    } else {
      around_.grid->for_each_candidate(p, cutoff, consider);
    }
    commands.found_top = commands.found.size();
  }

  void verify(Vector p, double cutoff, std::size_t first) const {
    std::vector<Id> ids;
    for (std::size_t k = first; k < around_.commands.found_top; ++k) {
      ids.push_back(world().agents.ids()[around_.commands.found[k]]);
    }
    verify_search(world(), p, cutoff, std::move(ids), [&](std::size_t row) { return row != row_; });
  }

  Neighbourhood<Model>& around_;
  std::size_t row_;
  int home_ = 0;  ///< tiled: the cell in which the turn began
};

}  // namespace gridlock
