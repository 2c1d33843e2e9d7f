#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>

#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "random_scene.hpp"

namespace gridlock::reference {

struct TiledSystem {
  SceneSettings scene;
  EngineSettings engine;
  double fastest = 1.0;  ///< some disks are so much faster that they wait for the end of the step

  [[nodiscard]] State start() const {
    State state = random_scene(scene);
    for (std::size_t i = 0; i < state.agents.size(); i += 7) state.agents.column<VelocityX>()[i] *= fastest;
    return state;
  }
};

/// Boxes from a single cell to many tiles, walls and periodic, equal disks and mixtures that overfill cells.
inline TiledSystem any_tiled_system(std::uint64_t seed) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  TiledSystem s;
  s.scene = {.edge = random.below(2) == 0 ? Edge::wall : Edge::periodic,
             .width = 0.5 + 2.0 * random.uniform(),
             .height = 0.5 + 2.0 * random.uniform(),
             .count = random.below(3) == 0 ? 1 + random.below(30) : 300 + random.below(900),
             .packing_fraction = random.below(3) == 0 ? 0.05 : 0.1 + 0.6 * random.uniform(),
             .smallest_ratio = random.below(2) == 0 ? 1.0 : 0.2 + 0.8 * random.uniform(),
             .heaviest_mass = random.below(2) == 0 ? 1.0 : 20.0,
             .seed = seed};
  s.engine = {.kind = "tiled",
              .time_step = 0.02 + 0.3 * random.uniform(),
              .substeps = 1 + random.below(8),
              .contact = random.below(2) == 0 ? CollisionRule::always : CollisionRule::approaching};
  s.fastest = random.below(3) == 0 ? 6.0 : 1.0;
  return s;
}

struct Ended {
  std::uint64_t hash = 0;
  Counters counters;
  std::string failure;
};

inline Ended advance(EngineSettings settings, std::uint64_t threads, State& state, std::uint64_t step) {
  settings.threads = threads;
  Ended ended;
  try {
    make_engine(settings, state)->advance(state, ended.counters, {.step = step});
  } catch (std::exception const& error) {
    ended.failure = error.what();
  }
  ended.hash = hash(state);
  return ended;
}

}  // namespace gridlock::reference
