#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "golden/hashes.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"
#include "tiled_colloid.hpp"

namespace gridlock::golden {

inline constexpr std::uint64_t seed_of_models = 20;

inline Box const walls(1.0, 1.0, Edge::wall);
inline Box const periodic(1.0, 1.0, Edge::periodic);

/// Calls visit(scene, model, box, steps) for those of models that ranks can share.
template <class Visit>
void for_each_shared_scene(Visit visit) {
  visit("vicsek", Flocking{.count = 600}, Box(12.0, 9.0, Edge::periodic), 100);
  visit("boids", Flocking{.count = 300, .rule = FlockingRule::boids, .radius = 5.0, .speed = 1.0},
        Box(100.0, 100.0, Edge::periodic), 100);
  // With births and deaths.
  Epidemic const epidemic{.count = 900, .infected_at_start = 0.1, .radius = 0.05, .speed = 0.3, .turnover_rate = 0.5};
  visit("walls", epidemic, walls, 100);
  visit("periodic", epidemic, periodic, 100);
  // Tile by tile.
  TiledColloid colloid;
  colloid.disks = {.count = 5000, .packing_fraction = 0.6, .start = StartKind::triangular};
  visit("crowd", colloid, walls, 40);
}

/// The hashes of a world as it starts and as advance(world) leaves it.
template <class Model, class Advance>
Hashes hashes_of(Model const& model, Box const& box, Advance advance) {
  World<Model> world{.box = box, .seed = seed_of_models};
  start_agents(model, world);
  std::string const start = fmt::format("{:016x}", hash(world));
  advance(world);
  // A scene in which nothing happens would prove nothing.
  bool const all_happen = std::ranges::all_of(world.events, [](std::uint64_t count) { return count > 0; });
  return {start, all_happen ? fmt::format("{:016x}", hash(world)) : "nothing happens"};
}
/// The same after so many steps in one process.
template <class Model>
Hashes hashes_of(Model const& model, Box const& box, std::uint64_t steps, ModelEngineSettings const& settings) {
  return hashes_of(model, box, [&](World<Model>& world) {
    ModelEngine<Model>(model, box, settings).advance(world, {.step = steps});
  });
}

}  // namespace gridlock::golden
