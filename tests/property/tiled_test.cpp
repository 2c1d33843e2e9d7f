// The engine `tiled`: the same bits for any number of threads, an order of turns that is a function of the state alone,
// and every promise of the paper's rule.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/grid/validate.hpp"
#include "gridlock/lattice/start.hpp"
#include "reference/random_scene.hpp"
#include "reference/shuffled_rows.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;
using reference::with_rows_shuffled;

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
TiledSystem any_tiled_system(std::uint64_t seed) {
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

Ended advance(EngineSettings settings, std::uint64_t threads, State& state, std::uint64_t step) {
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

TEST(Tiled, GivesTheSameBitsForOneTwoThreeAndEightThreads) {
  int with_collisions = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State const start = s.start();
    State state = start;
    Ended const one = advance(s.engine, 1, state, 40);
    if (one.counters.pair_collisions > 50) ++with_collisions;
    for (std::uint64_t const threads : {2U, 3U, 8U}) {
      state = start;
      Ended const many = advance(s.engine, threads, state, 40);
      ASSERT_EQ(one.hash, many.hash) << "seed " << seed << ", " << threads << " threads: " << s.scene;
      ASSERT_EQ(one.failure, many.failure) << "seed " << seed;
      ASSERT_EQ(one.counters.moves, many.counters.moves);
      ASSERT_EQ(one.counters.pair_collisions, many.counters.pair_collisions);
      ASSERT_EQ(one.counters.pair_virial, many.counters.pair_virial);
      ASSERT_EQ(one.counters.wall_impulse, many.counters.wall_impulse);
      ASSERT_EQ(one.counters.distance_checks, many.counters.distance_checks);
    }
  }
  EXPECT_GT(with_collisions, 30) << "most systems must do something";
}

TEST(Tiled, VisitsInAnOrderThatIsAFunctionOfTheStateAlone) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State whole = s.start();
    State cut = whole;
    State shuffled = with_rows_shuffled(whole, seed);
    Ended const ended = advance(s.engine, 1, whole, 150);
    if (!ended.failure.empty()) continue;
    EXPECT_EQ(ended.hash, advance(s.engine, 2, shuffled, 150).hash) << "seed " << seed << ": " << s.scene;
    // Cut into pieces, each with an engine of its own, as a run that continues from a file has it.
    for (std::uint64_t const step : {1U, 2U, 37U, 99U, 101U, 150U}) advance(s.engine, 1, cut, step);
    EXPECT_EQ(ended.hash, hash(cut)) << "seed " << seed << ": " << s.scene;
  }
}

TEST(Tiled, KeepsEveryPromiseOfTheRule) {
  for (std::uint64_t seed = 200; seed < 260; ++seed) {
    TiledSystem const s = any_tiled_system(seed);
    State state = s.start();
    double const energy = kinetic_energy(state.agents);
    Ended const ended = advance(s.engine, 2, state, 80);
    EXPECT_EQ(largest_overlap(state), 0.0) << "seed " << seed << ": " << s.scene;
    EXPECT_NO_THROW(validate(state)) << "seed " << seed;
    EXPECT_NEAR(kinetic_energy(state.agents), energy, 1e-11 * energy) << "seed " << seed;
    if (!ended.failure.empty()) continue;
    EXPECT_EQ(ended.counters.moves, 80 * state.agents.size()) << "seed " << seed << ": " << s.scene;
  }
}

TEST(Tiled, TakesTheTurnsOfSteppedWhereNoneMeetsAnother) {
  // Without collisions the order does not matter: the same positions as disk after disk.
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    State tiled = make_start(Box(1.0, 1.0, edge), {.count = 400, .packing_fraction = 0.02}, 5);
    draw_velocities(tiled, {});
    State stepped = tiled;
    Counters counters;
    Counters reference;
    make_engine({.kind = "tiled"}, tiled)->advance(tiled, counters, {.step = 6});
    make_engine({.kind = "stepped"}, stepped)->advance(stepped, reference, {.step = 6});
    ASSERT_EQ(reference.pair_collisions, 0U);
    EXPECT_EQ(hash(tiled), hash(stepped));
  }
}

}  // namespace
}  // namespace gridlock
