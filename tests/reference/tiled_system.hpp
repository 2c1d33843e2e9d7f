#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

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
             .smallest_ratio = random.below(2) == 0 ? 1.0 : 0.05 + 0.95 * random.uniform(),
             .heaviest_mass = random.below(2) == 0 ? 1.0 : 20.0,
             .seed = seed};
  s.engine = {.kind = "tiled",
              .time_step = 0.02 + 0.3 * random.uniform(),
              .substeps = 1 + random.below(8),
              .contact = random.below(2) == 0 ? CollisionRule::always : CollisionRule::approaching};
  s.fastest = random.below(3) == 0 ? 6.0 : 1.0;
  if (random.below(2) == 0) s.scene.edge_y = random.below(2) == 0 ? Edge::wall : Edge::periodic;
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

inline void expect_same(Ended const& one, Ended const& many, std::string const& what) {
  ASSERT_EQ(one.failure, many.failure) << what;
  ASSERT_EQ(one.hash, many.hash) << what;
  ASSERT_EQ(one.counters.moves, many.counters.moves) << what;
  ASSERT_EQ(one.counters.halted_moves, many.counters.halted_moves) << what;
  ASSERT_EQ(one.counters.pair_collisions, many.counters.pair_collisions) << what;
  ASSERT_EQ(one.counters.pair_virial, many.counters.pair_virial) << what;
  ASSERT_EQ(one.counters.wall_hits, many.counters.wall_hits) << what;
  ASSERT_EQ(one.counters.wall_impulse, many.counters.wall_impulse) << what;
  ASSERT_EQ(one.counters.distance_checks, many.counters.distance_checks) << what;
}

/// Sixty systems end as one thread of one process ends them, whatever the number of threads or ranks;
/// `advance_on(system, number, state, step)` moves one on.
template <class AdvanceOn>
void expect_same_of_any_system(std::vector<std::size_t> const& numbers, std::string const& of, AdvanceOn advance_on) {
  constexpr std::uint64_t steps = 40;
  int with_collisions = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State const start = s.start();
    State state = start;
    Ended const one = advance(s.engine, 1, state, steps);
    if (one.counters.pair_collisions > 50) ++with_collisions;
    for (std::size_t const number : numbers) {
      state = start;
      Ended const many = advance_on(s, number, state, steps);
      ASSERT_NO_FATAL_FAILURE(
          expect_same(one, many, "seed " + std::to_string(seed) + ", " + std::to_string(number) + " " + of));
    }
  }
  EXPECT_GT(with_collisions, 30) << "most systems must do something";
}

}  // namespace gridlock::reference
