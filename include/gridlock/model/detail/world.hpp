#pragma once

#include <cstddef>
#include <optional>
#include <tuple>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/model/agent_sums.hpp"

namespace gridlock {

/// The order in which agents of a model take their turns.
enum class Schedule {
  synchronous,  ///< all at once: an agent reads the world before the step, and changes only itself
  sequential,   ///< one after the other in the order of the Ids; an agent reads the changes of earlier turns
  tiled,        ///< one after the other in each tile, tiles far apart at the same time; see Tiling and ClassOrder
  events,       ///< no turns: the model changes the whole world, one event after the other
};

template <class Agents>
Vector position_of(typename Agents::Values const& values) {
  return {std::get<Agents::template place_of<X>>(values), std::get<Agents::template place_of<Y>>(values)};
}

/// Returns whether the model makes its first agents one by one, by Model::first_agent().
template <class Model>
consteval bool has_first_agents() {
  return requires(Model const& model, World<Model> const& world) {
    model.first_agent(world, 0);
    model.agents_at_start();
  };
}

/// Returns whether the model says which of its agents take a turn in a step.
template <class Model>
consteval bool has_sleepers() {
  return requires(Model const& model, World<Model> const& world) { model.is_awake(world, std::size_t{}); };
}

/// Returns whether the agent of a row takes a turn in this step.
template <class Model>
bool is_awake([[maybe_unused]] Model const& model, [[maybe_unused]] World<Model> const& world,
              [[maybe_unused]] std::size_t row) {
  if constexpr (has_sleepers<Model>()) {
    return model.is_awake(world, row);
  } else {
    return true;
  }
}

/// Returns the cutoff of a model, which may depend on its world or on sums over all agents. `world` has the agents of
/// this process; all processes that share the agents call it together.
template <class Model>
double cutoff_of(Model const& model, World<Model> const& world, AllProcesses processes = {}) {
  constexpr bool asks_world = requires { model.cutoff(world); };
  constexpr bool asks_agents = requires { model.cutoff(AgentSums<Model>(world)); };
  if constexpr (asks_world) {
    return model.cutoff(world);
  } else if constexpr (asks_agents) {
    return model.cutoff(AgentSums<Model>(world, processes));
  } else {
    return model.cutoff();
  }
}
/// Returns the physical time of a step; all processes that share the agents call it together.
template <class Model>
double time_step_of(Model const& model, World<Model> const& world, AllProcesses processes = {}) {
  constexpr bool asks_world = requires { model.time_step(world); };
  constexpr bool asks_agents = requires { model.time_step(AgentSums<Model>(world)); };
  if constexpr (asks_world) {
    return model.time_step(world);
  } else if constexpr (asks_agents) {
    return model.time_step(AgentSums<Model>(world, processes));
  } else {
    return model.time_step();
  }
}
/// Returns the cells that the model chooses, if any; all processes that share the agents call it together.
template <class Model>
std::optional<CellLayout> cells_of(Model const& model, World<Model> const& world, AllProcesses processes = {}) {
  constexpr bool asks_world = requires { model.cells(world); };
  constexpr bool asks_agents = requires { model.cells(AgentSums<Model>(world)); };
  if constexpr (asks_world) {
    return model.cells(world);
  } else if constexpr (asks_agents) {
    return model.cells(AgentSums<Model>(world, processes));
  } else {
    return {};
  }
}

/// Returns whether the cutoff, the time step or the cells of a model depend on the World, and so may change in every
/// step.
template <class Model>
consteval bool asks_world_in_every_step() {
  constexpr bool for_cutoff = requires(Model const& model, World<Model> const& world) { model.cutoff(world); };
  constexpr bool for_time_step = requires(Model const& model, World<Model> const& world) { model.time_step(world); };
  constexpr bool for_cells = requires(Model const& model, World<Model> const& world) { model.cells(world); };
  return for_cutoff || for_time_step || for_cells;
}

}  // namespace gridlock
