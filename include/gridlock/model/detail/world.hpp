#pragma once

#include <optional>
#include <tuple>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/world.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/model/agent_sums.hpp"

namespace gridlock {

/// How the agents of a model take their turns.
enum class Schedule {
  synchronous,  ///< all at once: everybody sees the world as it was before the step, and changes only itself
  sequential,   ///< one after the other in the order of the Ids; everybody sees what the others have just done
  tiled,   ///< the same tile by tile, see Tiling and ClassOrder: far from one another many take their turns at once
  events,  ///< no turns: the model carries the whole world through a step, one event after the other
};

/// Where an agent with these values is.
template <class Agents>
Vector position_of(typename Agents::Values const& values) {
  return {std::get<Agents::template place_of<X>>(values), std::get<Agents::template place_of<Y>>(values)};
}

/// Whether the first agents are functions of their numbers, Model::first_agent().
template <class Model>
consteval bool has_first_agents() {
  return requires(Model const& model, World<Model> const& world) {
    model.first_agent(world, 0);
    model.agents_at_start();
  };
}

/// The distance to which an agent of the model searches: a number of the model alone, of its world, or of all agents.
/// `world` has the agents of this process; all that share the agents call it together.
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
/// The physical time of a step; the same.
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
/// The cells that the model fixes, if it does; the same.
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

/// Whether the cutoff, the time step or the cells of a model may be others in every step: they ask the World.
template <class Model>
consteval bool asks_world_in_every_step() {
  constexpr bool for_cutoff = requires(Model const& model, World<Model> const& world) { model.cutoff(world); };
  constexpr bool for_time_step = requires(Model const& model, World<Model> const& world) { model.time_step(world); };
  constexpr bool for_cells = requires(Model const& model, World<Model> const& world) { model.cells(world); };
  return for_cutoff || for_time_step || for_cells;
}

}  // namespace gridlock
