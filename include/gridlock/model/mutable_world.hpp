#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/model/detail/checks.hpp"
#include "gridlock/model/detail/motion.hpp"
#include "gridlock/model/detail/verify.hpp"
#include "gridlock/model/detail/world.hpp"
#include "gridlock/model/fields.hpp"

namespace gridlock {

/// The mutable world of a model of events: every birth, death and move takes effect at once.
///
/// Cost: O(1) for each change. Among a million agents at random positions a birth and a death take about 330 ns, mostly
/// two waits for memory, or 90 ns by add_all() and remove_all().
/// Errors: RunFailure, in every build, for an Id that is not alive, a birth or move to a point outside the box, a
/// search beyond the model's cutoff, an event that is not declared, a point of a field outside the box, an amount to
/// take that is no number from 0 on, and a deposit that makes a value infinite or no number.
///
/// ```cpp
/// struct Pairs {
///   using Agents = Population<X, Y>;
///   void step(MutableWorld<Pairs>& world) const {
///     Id const first = world.agent_in_row(0);
///     auto const second = world.nearest(world.position(first), 0.1, first);
///     if (second) world.remove(*second);
///   }
/// };
/// ```
template <class Model>
class MutableWorld {
 public:
  using Agents = typename World<Model>::Agents;
  using Row = typename Agents::Values;  ///< one value per column

  MutableWorld(World<Model>& world, PackedGrid& grid, double cutoff, bool is_verified)
      : world_(world), grid_(grid), cutoff_(cutoff), is_verified_(is_verified) {}

  [[nodiscard]] Box const& box() const { return world_.box; }
  [[nodiscard]] Clock const& clock() const { return world_.clock; }
  [[nodiscard]] std::size_t size() const { return world_.agents.size(); }
  /// Returns the Id of the agent in a row below size(); a random row draws every agent with the same chance.
  [[nodiscard]] Id agent_in_row(std::size_t row) const {
    last_row_ = row;
    grid_.prefetch(row);
    return world_.agents.ids()[row];
  }
  /// Returns the Ids of all agents in a random order, each order with the same chance. Cost: about 10 ns an agent.
  [[nodiscard]] std::vector<Id> agents_in_random_order(RandomStream& random) const {
    std::vector<Id> ids(world_.agents.ids().begin(), world_.agents.ids().end());
    for (std::size_t left = ids.size(); left > 1; --left) std::swap(ids[left - 1], ids[random.below(left)]);
    return ids;
  }
  [[nodiscard]] bool contains(Id id) const { return world_.agents.contains(id); }

  template <class Column>
  [[nodiscard]] typename Column::type get(Id id) const {
    return world_.agents.template column<Column>()[living_row_of(id)];
  }
  template <class Column>
  void set(Id id, typename Column::type value) {
    static_assert(!std::is_same_v<Column, X> && !std::is_same_v<Column, Y>, "move_to() tells the grid, too");
    world_.agents.template column<Column>()[living_row_of(id)] = value;
  }
  [[nodiscard]] Vector position(Id id) const { return {get<X>(id), get<Y>(id)}; }

  /// Return a field, and its value in the cell around a point; beyond a periodic edge a point stands for its image.
  template <class Tag>
  [[nodiscard]] Field const& field() const {
    return field_of<Tag>(world_);
  }
  template <class Tag>
  [[nodiscard]] double at(Vector p) const {
    return field<Tag>().values()[cell_around(field<Tag>(), box(), p, clock().step)];
  }
  /// Adds an amount to the cell around a point.
  template <class Tag>
  void deposit(Vector p, double amount) {
    deposit_now(field_of<Tag>(world_), cell_around(field<Tag>(), box(), p, clock().step), amount, clock().step);
  }
  /// Takes at most `amount` from the cell around a point, and returns what was there.
  template <class Tag>
  double take(Vector p, double amount) {
    require_amount_to_take(field<Tag>(), amount, clock().step, {});
    return take_now(field_of<Tag>(world_), cell_around(field<Tag>(), box(), p, clock().step), amount);
  }

  /// Returns the random numbers for all events of this step.
  [[nodiscard]] RandomStream random() const { return {world_.seed, world_.clock.step, 0, Purpose::model_step}; }

  /// Adds a newborn agent with one value per column, in the order the columns are declared, and returns its Id.
  template <class... Values>
  Id add(Values... values) {
    Vector const p = position_of<Agents>(Row{values...});
    if (!is_inside(world_.box, p)) throw_birth_outside(world_.clock.step, {}, p, world_.box);
    Id const id = world_.agents.add(values...);
    grid_.insert(size() - 1, p);
    return id;
  }
  void remove(Id id) {
    std::size_t const row = row_of(id);
    std::size_t const last = size() - 1;
    grid_.erase(row);
    // remove() will move the last row into the row of the dead agent.
    if (row != last) grid_.rename(last, row);
    world_.agents.remove(id);
  }
  /// Remove or add many agents with the same result as remove() or add() one by one, but several times faster, since
  /// the memory of later agents is prefetched.
  void remove_all(std::span<Id const> ids) {
    carry_out_with_look_ahead(
        ids.size(), [&](std::size_t k) { world_.agents.prefetch(ids[k]); },
        [&](std::size_t k) {
          world_.agents.prefetch_row(ids[k]);
          grid_.prefetch(world_.agents.index_of(ids[k]));
        },
        [&](std::size_t k) { grid_.prefetch_block_of(world_.agents.index_of(ids[k])); },
        [&](std::size_t k) { grid_.prefetch_successor_of(world_.agents.index_of(ids[k])); },
        [&](std::size_t k) { remove(ids[k]); });
  }
  void add_all(std::span<typename Agents::Values const> newborn) {
    carry_out_with_look_ahead(
        newborn.size(), [&](std::size_t k) { grid_.prefetch_cell_of(position_of<Agents>(newborn[k])); },
        [&](std::size_t k) { grid_.prefetch_second_block_of(position_of<Agents>(newborn[k])); },
        [&](std::size_t k) { std::apply([&](auto... values) { add(values...); }, newborn[k]); });
  }
  void move_to(Id id, Vector p) {
    std::size_t const row = row_of(id);
    if (!is_inside(world_.box, p)) throw_outside(world_.clock.step, id, p, world_.box);
    world_.agents.template column<X>()[row] = p.x;
    world_.agents.template column<Y>()[row] = p.y;
    grid_.move(row, p);
  }

  /// Returns the agent nearest to `p`, if one other than `except` is nearer than `cutoff`; of two at the same distance
  /// that with the lower Id.
  [[nodiscard]] std::optional<Id> nearest(Vector p, double cutoff, std::optional<Id> except = {}) const {
    double nearest = cutoff * cutoff;
    std::optional<Id> found;
    for_each_row_within(p, cutoff, except, [&](std::size_t row, double squared_distance) {
      Id const id = world_.agents.ids()[row];
      if (squared_distance < nearest || (found && squared_distance == nearest && id < *found)) {
        nearest = squared_distance;
        found = id;
      }
    });
    return found;
  }
  /// Calls visit(id) for every agent nearer to `p` than `cutoff`, in the order of the Ids.
  template <class Visit>
  void for_each_neighbour(Vector p, double cutoff, Visit visit) const {
    std::vector<Id> ids;
    for_each_row_within(p, cutoff, {}, [&](std::size_t row, double) { ids.push_back(world_.agents.ids()[row]); });
    std::ranges::sort(ids);
    for (Id const id : ids) visit(id);
  }

  /// Counts an event of the model, see `Model::events`.
  void count(std::size_t event) {
    if (event >= event_names<Model>().size()) {
      throw_unknown_event(world_.clock.step, {}, event, event_names<Model>());
    }
    ++world_.events[event];
  }

 private:
  [[nodiscard]] Vector position_of_row(std::size_t row) const {
    return {world_.agents.template column<X>()[row], world_.agents.template column<Y>()[row]};
  }

  template <class Visit>
  void for_each_row_within(Vector p, double cutoff, std::optional<Id> except, Visit visit) const {
    if (!(cutoff >= 0.0 && cutoff <= cutoff_ && is_finite(p))) {
      throw_far_search(
          {.step = world_.clock.step, .agent = {}, .point = p, .position = p, .cutoff = cutoff, .declared = cutoff_});
    }
    std::size_t const left_out = except ? world_.agents.index_of(*except) : Agents::not_found;
    std::vector<Id> found;
    grid_.for_each_candidate(p, cutoff, [&](std::size_t row) {
      double const squared_distance = squared_length(world_.box.displacement(p, position_of_row(row)));
      if (row == left_out || !(squared_distance < cutoff * cutoff)) return;
      if (is_verified_) found.push_back(world_.agents.ids()[row]);
      visit(row, squared_distance);
    });
    if (is_verified_) {
      verify_search(world_, p, cutoff, std::move(found), [&](std::size_t row) { return row != left_out; });
    }
  }

  /// Returns the row of an agent. Most Ids come from agent_in_row(): the remembered row spares a lookup in memory.
  [[nodiscard]] std::size_t row_of(Id id) const {
    if (last_row_ < size() && world_.agents.ids()[last_row_] == id) return last_row_;
    return living_row_of(id);
  }
  [[nodiscard]] std::size_t living_row_of(Id id) const {
    std::size_t const row = world_.agents.index_of(id);
    if (row == Agents::not_found) throw_not_alive(world_.clock.step, id);
    return row;
  }

  World<Model>& world_;
  PackedGrid& grid_;
  double cutoff_;
  mutable std::size_t last_row_ = 0;
  bool is_verified_;
};

}  // namespace gridlock
