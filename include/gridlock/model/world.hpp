#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <tuple>

#include "gridlock/core/random.hpp"
#include "gridlock/core/state.hpp"

namespace gridlock {

/// How the agents of a model take their turns.
enum class Schedule {
  synchronous,  ///< all at once: everybody sees the world as it was before the step, and changes only itself
  sequential,   ///< one after the other in the order of the Ids; everybody sees what the others have just done
  tiled,   ///< the same tile by tile, see Tiling and UpdateOrder: far from one another many take their turns at once
  events,  ///< no turns: the model carries the whole world through a step, one event after the other
};

/// The names of what is counted in a model, `Model::events`; none where it declares none.
template <class Model>
constexpr std::span<std::string_view const> event_names() {
  if constexpr (requires { Model::events; }) {
    return Model::events;
  } else {
    return {};
  }
}

/// How often each event has happened, in the order of `Model::events`.
template <class Model>
using EventCounts = std::array<std::uint64_t, event_names<Model>().size()>;

/// The agents of a model and the box they live in, with what has happened to them since the start.
template <class Model>
struct World {
  using Agents = typename Model::Agents;

  Box box;
  Agents agents;
  Clock clock;
  std::uint64_t seed = 0;
  EventCounts<Model> events{};  ///< no part of the state: nothing depends on it

  /// Random numbers for agent `number` of the start.
  [[nodiscard]] RandomStream start_random(std::uint64_t number) const {
    return {seed, 0, number, Purpose::model_start};
  }
  /// A point anywhere in the box.
  [[nodiscard]] Vector anywhere(RandomStream& random) const {
    double const x = random.uniform() * box.width();
    return {x, random.uniform() * box.height()};
  }
};

/// Where an agent with these values is.
template <class Agents>
Vector position_of(typename Agents::Values const& values) {
  return {std::get<Agents::template place_of<X>>(values), std::get<Agents::template place_of<Y>>(values)};
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

/// The bitwise identity of all agents; equal to that of a State where the agents are Disks.
template <class Model>
std::uint64_t hash(World<Model> const& world) {
  return hash(world.box, world.clock, world.seed, world.agents);
}

template <class Model>
void serialize(Archive& archive, World<Model>& world) {
  serialize_inside(archive, "box", [&] { serialize(archive, world.box); });
  serialize_inside(archive, "clock", [&] { serialize(archive, world.clock); });
  archive.visit("seed", world.seed);
  serialize_inside(archive, "agents", [&] { world.agents.serialize(archive); });
  serialize_inside(archive, "events", [&] {
    for (std::size_t k = 0; k < world.events.size(); ++k) archive.visit(event_names<Model>()[k], world.events[k]);
  });
}

}  // namespace gridlock
