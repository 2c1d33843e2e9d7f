#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <type_traits>
#include <vector>

#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/model/detail/world.hpp"
#include "gridlock/model/fields.hpp"
#include "gridlock/model/networks.hpp"

namespace gridlock {

/// The births, deaths and events that agents of one part of the world have requested in their turns. They take effect
/// after all turns, so that no row moves while neighbours are visited.
template <class Model>
struct DeferredCommands {
  std::vector<typename World<Model>::Agents::Values> births;
  std::vector<Id> parents;  ///< the parent of each birth
  std::vector<Id> deaths;   ///< an Id may be listed twice
  EventCounts<Model> events{};
  std::array<FieldRequests, FieldsOf<Model>::count> fields{};  ///< in the order of World::fields
  std::vector<std::uint32_t> found;  ///< stack of rows found; a search in a search adds on top
  std::size_t found_top = 0;

  void append(DeferredCommands const& part) {
    deaths.insert(deaths.end(), part.deaths.begin(), part.deaths.end());
    births.insert(births.end(), part.births.begin(), part.births.end());
    parents.insert(parents.end(), part.parents.begin(), part.parents.end());
    for (std::size_t k = 0; k < events.size(); ++k) events[k] += part.events[k];
    for (std::size_t k = 0; k < fields.size(); ++k) fields[k].append(part.fields[k]);
  }
  void clear() {
    births.clear();
    parents.clear();
    deaths.clear();
    events = {};
    for (FieldRequests& requests : fields) requests.clear();
  }
};

template <class Agents>
void remove_agents(Agents& agents, std::span<Id const> ids) {
  carry_out_with_look_ahead(
      ids.size(), [&](std::size_t k) { agents.prefetch(ids[k]); }, [&](std::size_t k) { agents.prefetch_row(ids[k]); },
      [&](std::size_t k) { agents.remove(ids[k]); });
}

/// The changes of all fields by the turns of one step.
template <class Model>
class ChangesOfFields {
 public:
  /// Resolves the requests of all parts, see resolve(), and removes them; the world stays. Errors: those of resolve().
  ChangesOfFields(World<Model> const& world, std::span<DeferredCommands<Model>> parts) {
    for (std::size_t k = 0; k < requests_.size(); ++k) {
      for (DeferredCommands<Model>& part : parts) {
        requests_[k].append(part.fields[k]);
        part.fields[k].clear();
      }
    }
    for (std::size_t k = 0; k < requests_.size(); ++k) {
      cells_[k] = resolve(world.fields[k], requests_[k], world.seed, world.clock.step);
    }
  }
  /// Gives the cells their new values, and the agents that took theirs. Contract: the rows are those of the turns.
  void apply(World<Model>& world) const {
    for (std::size_t k = 0; k < requests_.size(); ++k) {
      for (ChangedCell const& changed : cells_[k]) world.fields[k].values()[changed.cell] = changed.value;
      for (Take const& take : requests_[k].takes) give(world.agents, take);
    }
  }

 private:
  template <class... Columns>
  static void give(Population<Columns...>& agents, Take const& take) {
    auto const give_to = [&](auto column_type) {
      using Column = typename decltype(column_type)::type;
      if constexpr (std::is_same_v<typename Column::type, double>) {
        if (take.column != Population<Columns...>::template place_of<Column>) return;
        agents.template column<Column>()[take.row] += take.amount;
      }
    };
    (give_to(std::type_identity<Columns>{}), ...);
  }

  std::array<FieldRequests, FieldsOf<Model>::count> requests_;
  std::array<std::vector<ChangedCell>, FieldsOf<Model>::count> cells_;
};

/// Applies all commands: first deaths in the order of the Ids, then births in the order of the parents' Ids, births of
/// one parent in the order of its calls. This order depends on the state alone, so that the Ids of newborns are the
/// same on any number of threads. Edges of the dead vanish. Returns the births if the model has networks. Contract: all
/// commands of an agent are in one part.
template <class Model>
std::vector<Birth> apply_commands(World<Model>& world, std::span<DeferredCommands<Model>> parts) {
  DeferredCommands<Model> all;
  for (DeferredCommands<Model>& part : parts) {
    all.append(part);
    part.clear();
  }
  for (std::size_t k = 0; k < world.events.size(); ++k) world.events[k] += all.events[k];
  std::vector<Id> deaths;
  deaths.reserve(all.deaths.size());
  for (std::size_t const place : rows_in_order(all.deaths)) {
    if (deaths.empty() || deaths.back() != all.deaths[place]) deaths.push_back(all.deaths[place]);
  }
  remove_agents<typename World<Model>::Agents>(world.agents, deaths);
  for (Network& network : world.networks) network.remove_agents(deaths);
  std::vector<Birth> births;
  for (std::size_t const place : rows_in_order(all.parents)) {
    Id const child = std::apply([&](auto... values) { return world.agents.add(values...); }, all.births[place]);
    if constexpr (has_networks<Model>()) births.push_back({.parent = all.parents[place], .child = child});
  }
  return births;
}

}  // namespace gridlock
