// What must hold for any model: the same bits on any number of threads and after any cut into chunks, births and deaths
// included, and no neighbour missed.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {
namespace {

template <class Model>
World<Model> started(Model const& model, Box const& box) {
  World<Model> world{.box = box, .seed = 7};
  model.start(world);
  return world;
}

template <class Model>
std::uint64_t hash_after(Model const& model, Box const& box, std::uint64_t steps, ModelEngineSettings const& settings,
                         std::uint64_t chunk) {
  World<Model> world = started(model, box);
  ModelEngine<Model> engine(model, box, settings);
  for (std::uint64_t step = 0; step < steps; step += chunk) engine.advance(world, {.step = step + chunk});
  EXPECT_EQ(world.clock.step, steps);
  return hash(world);
}

Epidemic restless() {
  return {.count = 700, .infected_at_start = 0.2, .radius = 0.05, .speed = 0.3, .turnover_rate = 1.0};
}

template <class Model>
void expect_same_bits(Model const& model, Box const& box) {
  std::uint64_t const expected = hash_after(model, box, 60, {.threads = 1}, 60);
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(hash_after(model, box, 60, {.threads = threads}, 60), expected) << threads << " threads";
  }
  EXPECT_EQ(hash_after(model, box, 60, {.threads = 3}, 1), expected) << "chunks of one step";
}

TEST(ModelThreads, BirthsAndDeathsAndTheirNamesAreTheSameOnAnyNumberOfThreads) {
  expect_same_bits(restless(), Box(1.0, 1.0, Edge::wall));
  expect_same_bits(restless(), Box(1.3, 0.7, Edge::periodic));
}

TEST(ModelThreads, FlocksAreTheSameOnAnyNumberOfThreads) {
  expect_same_bits(Flocking{.count = 500}, Box(12.0, 9.0, Edge::periodic));
  expect_same_bits(Flocking{.count = 300, .rule = FlockingRule::boids, .radius = 5.0, .speed = 1.0},
                   Box(100.0, 100.0, Edge::periodic));
}

TEST(ModelSearch, MissesNobodyInAnyBox) {
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    for (double const side : {2.0, 2.5, 3.1, 4.2, 5.0, 9.7}) {
      Box const box(side, edge == Edge::wall ? 0.7 * side : 2.0 + 0.3 * side, edge);
      Flocking const model{.count = 90, .speed = 0.4};
      EXPECT_NO_THROW(hash_after(model, box, 20, {.threads = 2, .verify_every = 1}, 20)) << side;
    }
  }
}

TEST(ModelSearch, ADifferenceFromBruteForceEndsTheRun) {
  Box const box(20.0, 20.0, Edge::periodic);
  World<Flocking> world{.box = box, .seed = 1};
  Flocking{.count = 200}.start(world);
  Requests<Flocking> requests;
  EXPECT_THROW(verify_search(world, {1.0, 1.0}, 5.0, {}, [](std::size_t) { return true; }), RunFailure);
}

TEST(ModelBox, APeriodicBoxInWhichAnAgentCouldSeeTwoImagesIsRefused) {
  EXPECT_THROW(ModelEngine<Flocking>({}, Box(1.9, 5.0, Edge::periodic), {}), Error);
  EXPECT_NO_THROW(ModelEngine<Flocking>({}, Box(1.9, 5.0, Edge::wall), {}));
}

/// Each has a child beside itself in every step, or all die.
struct Tribe {
  static constexpr std::string_view name = "tribe";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  bool dies = false;
  double reach() const { return 0.1; }
  double time_step() const { return 1.0; }
  void turn(Turn<Tribe>& self) const {
    Vector const p = self.position();
    if (dies) {
      self.die();
    } else {
      self.give_birth(p.x, p.y);  // identical positions
    }
  }
};

TEST(ModelPopulation, EveryoneMayDieAndOneMayBecomeMany) {
  Box const box(1.0, 1.0, Edge::periodic);
  World<Tribe> world{.box = box, .seed = 1};
  world.agents.add(0.5, 0.5);
  ModelEngine<Tribe> growing({}, box, {.threads = 2});
  growing.advance(world, {.step = 14});
  EXPECT_EQ(world.agents.size(), std::size_t{1} << 14);
  ModelEngine<Tribe> dying({.dies = true}, box, {.threads = 2});
  dying.advance(world, {.step = 16});
  EXPECT_EQ(world.agents.size(), 0U);
}

}  // namespace
}  // namespace gridlock
