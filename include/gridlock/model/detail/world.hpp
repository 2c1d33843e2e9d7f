#pragma once

#include <tuple>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/world.hpp"

namespace gridlock {

/// How the agents of a model take their turns.
enum class Schedule {
  synchronous,  ///< all at once: everybody sees the world as it was before the step, and changes only itself
  sequential,   ///< one after the other in the order of the Ids; everybody sees what the others have just done
  tiled,   ///< the same tile by tile, see Tiling and UpdateOrder: far from one another many take their turns at once
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

/// How far an agent of the model searches, and the physical time of a step: numbers of the model alone, or of its world.
template <class Model>
double cutoff_of(Model const& model, World<Model> const& world) {
  if constexpr (requires { model.cutoff(world); }) {
    return model.cutoff(world);
  } else {
    return model.cutoff();
  }
}
template <class Model>
double time_step_of(Model const& model, World<Model> const& world) {
  if constexpr (requires { model.time_step(world); }) {
    return model.time_step(world);
  } else {
    return model.time_step();
  }
}

/// Whether a model's cutoff(), time_step() and cells() are the same in all steps of a run, though they ask the World: it says so in
/// `static constexpr bool asks_world_once = true`, or they ask nothing.
template <class Model>
consteval bool asks_world_once() {
  if constexpr (requires { Model::asks_world_once; }) {
    return Model::asks_world_once;
  } else {
    return requires(Model const& model) {
      model.cutoff();
      model.time_step();
    }
    &&!requires(Model const& model, World<Model> const& world) { model.cells(world); };
  }
}

}  // namespace gridlock
