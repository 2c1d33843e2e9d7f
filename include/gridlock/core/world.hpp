#pragma once

/// \file
/// The world of a model: box, agents, clock and seed.
///
/// ```cpp
/// #include "gridlock/core/disks.hpp"
///
/// struct Walkers {
///   using Agents = Population<X, Y>;
/// };
/// inline std::uint64_t start() {
///   World<Walkers> world{.box = Box(1.0, 1.0, Edge::periodic), .seed = 7};
///   RandomStream random = world.start_random(0);
///   Vector const p = world.anywhere(random);
///   world.agents.add(p.x, p.y);
///   return hash(world);
/// }
/// ```

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/field.hpp"
#include "gridlock/core/network.hpp"
#include "gridlock/core/population.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/core/vector.hpp"

namespace gridlock {

/// The number of steps done, and the physical time.
struct Clock {
  std::uint64_t step = 0;
  double time = 0.0;

  friend bool operator==(Clock const&, Clock const&) = default;
};

/// Returns the names of the events that a model counts, `Model::events`; empty if the model declares no events.
template <class Model>
constexpr std::span<std::string_view const> event_names() {
  if constexpr (requires { Model::events; }) {
    return Model::events;
  } else {
    return {};
  }
}

/// The number of times that each event has happened, in the order of `Model::events`.
template <class Model>
using EventCounts = std::array<std::uint64_t, event_names<Model>().size()>;

/// The agents of a model with box, clock, seed, fields and networks: equal worlds stay equal under the same settings.
///
/// `Model` declares the columns, `using Agents = Population<X, Y, …>`. Hard disks are one model, see State.
template <class Model>
struct World {
  using Agents = typename Model::Agents;

  Box box;
  Agents agents;
  Clock clock;
  std::uint64_t seed = 0;
  EventCounts<Model> events{};  ///< counted since the start; not part of the state, since no move depends on the counts
  std::vector<Field> fields = {};      ///< numbers over the box, in the order of their names
  std::vector<Network> networks = {};  ///< edges between the agents, in the order of their names

  /// Returns the random numbers with which a model places its agent number `number` at the start.
  [[nodiscard]] RandomStream start_random(std::uint64_t number) const {
    return {seed, 0, number, Purpose::model_start};
  }
  /// Draws a uniform point in the box.
  [[nodiscard]] Vector anywhere(RandomStream& random) const {
    double const x = random.uniform() * box.width();
    return {x, random.uniform() * box.height()};
  }
};

/// Returns the hash XXH3 of words of 64 bits.
std::uint64_t hash_words(std::span<std::uint64_t const> words);

/// Returns the bits of a number as 64 bits, an integer with its sign extended.
template <class Value>
constexpr std::uint64_t word_of(Value value) {
  if constexpr (std::is_same_v<Value, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    return static_cast<std::uint64_t>(value);
  }
}

/// Returns the hash of a world from the number of its agents and the sum of their hashes; see sum_of_hashes().
std::uint64_t hash_of_world(Box const& box, Clock const& clock, std::uint64_t seed, std::size_t agents,
                            std::uint64_t sum_of_agents);

/// Returns the sum of the hashes of all agents, modulo 2⁶⁴. Cost: one pass over the agents.
template <class... Columns>
std::uint64_t sum_of_hashes(Population<Columns...> const& population) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < population.size(); ++i) {
    // All words have 64 bits: then a record has no padding, and the same bytes under every compiler.
    std::uint64_t const record[] = {population.ids()[i], word_of(population.template column<Columns>()[i])...};
    sum += hash_words(record);
  }
  return sum;
}

/// Returns the state hash of a population: equal for equal bits of box, clock, seed and every column of every agent.
///
/// The XXH3 hashes of all rows, each with the Id of its agent, are summed modulo 2⁶⁴: the order of the rows does not
/// matter.
/// Cost: one pass over the agents.
template <class... Columns>
std::uint64_t hash(Box const& box, Clock const& clock, std::uint64_t seed, Population<Columns...> const& population) {
  return hash_of_world(box, clock, seed, population.size(), sum_of_hashes(population));
}

/// Returns the state hash of a world; equal for worlds of two models with the same columns and values.
template <class Model>
std::uint64_t hash(World<Model> const& world) {
  std::uint64_t const of_agents = hash(world.box, world.clock, world.seed, world.agents);
  return hash_with_networks(hash_with_fields(of_agents, world.fields), world.networks);
}

/// Serializes every bit. Errors: Error if the restored values are no valid clock, box or world.
void serialize(Archive& archive, Clock& clock);
void serialize(Archive& archive, Box& box);
template <class Model>
void serialize(Archive& archive, World<Model>& world) {
  serialize_inside(archive, "box", [&] { serialize(archive, world.box); });
  serialize_inside(archive, "clock", [&] { serialize(archive, world.clock); });
  archive.visit("seed", world.seed);
  serialize_inside(archive, "agents", [&] { world.agents.serialize(archive); });
  serialize_inside(archive, "events", [&] {
    for (std::size_t k = 0; k < world.events.size(); ++k) archive.visit(event_names<Model>()[k], world.events[k]);
  });
  auto const serialize_all = [&](char const* name, auto& things) {
    if (things.empty()) return;
    serialize_inside(archive, name, [&] {
      for (auto& thing : things) thing.serialize(archive);
    });
  };
  serialize_all("fields", world.fields);
  serialize_all("networks", world.networks);
}
}  // namespace gridlock
