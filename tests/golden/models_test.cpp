// The bits of the shipped models, for ever, on 1, 2, 3 and 8 threads; how to accept others: see hashes_test.cpp.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <string>

#include "golden/table.hpp"
#include "models/catalyst.hpp"
#include "models/colloid.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {
namespace {

constexpr std::uint64_t seed = 20;

template <class Model>
Hashes run(Model const& model, Box const& box, std::uint64_t steps, std::uint64_t threads) {
  World<Model> world{.box = box, .seed = seed};
  model.start(world);
  std::string const start = fmt::format("{:016x}", hash(world));
  ModelEngine<Model>(model, box, {.threads = threads}).advance(world, {.step = steps});
  for (std::uint64_t const count : world.events) EXPECT_GT(count, 0U) << "a scene in which nothing happens";
  return {start, fmt::format("{:016x}", hash(world))};
}

template <class Model>
void expect_golden(std::string const& scene, Model const& model, Box const& box, std::uint64_t steps) {
  Hashes const now = run(model, box, steps, 1);
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(run(model, box, steps, threads).end, now.end) << threads << " threads";
  }
  HashTable("models.csv").expect({scene, std::string(Model::name)}, now);
}

Box const walls(1.0, 1.0, Edge::wall);
Box const periodic(1.0, 1.0, Edge::periodic);
Box const rectangle(12.0, 9.0, Edge::periodic);

TEST(GoldenModels, Vicsek) { expect_golden("vicsek", Flocking{.count = 600}, rectangle, 100); }

TEST(GoldenModels, Boids) {
  expect_golden("boids", Flocking{.count = 300, .rule = FlockingRule::boids, .radius = 5.0, .speed = 1.0},
                Box(100.0, 100.0, Edge::periodic), 100);
}

TEST(GoldenModels, EpidemicWithBirthsAndDeaths) {
  Epidemic const model{.count = 900, .infected_at_start = 0.1, .radius = 0.05, .speed = 0.3, .turnover_rate = 0.5};
  expect_golden("walls", model, walls, 100);
  expect_golden("periodic", model, periodic, 100);
}

TEST(GoldenModels, CatalystWithEveryEvent) {
  expect_golden("every_event",
                Catalyst{.adsorption_rate = 3000.0,
                         .adsorption_rate_b = 2000.0,
                         .desorption_rate = 0.5,
                         .hop_rate = 20.0,
                         .hop = 0.05,
                         .reaction = Reaction::a_with_b,
                         .reaction_probability = 0.5,
                         .step_length = 0.1},
                periodic, 20);
}

TEST(GoldenModels, ColloidInTheScenePaperOfTheEngines) {
  // The scene of the engines: the same start, and 0.5 in time, which their table measures in steps of this length.
  auto const expect_scene = [](auto model, std::string const& engine) {
    model.disks = {.count = 841, .packing_fraction = 0.7};
    World<decltype(model)> world{.box = walls, .seed = seed};
    model.start(world);
    ModelEngine<decltype(model)> colloid(model, walls, {.threads = 2});
    std::string const start = fmt::format("{:016x}", hash(world));
    colloid.advance(world, {.time = 0.5});
    HashTable("hashes.csv").expect({"paper", engine}, {start, fmt::format("{:016x}", hash(world))});
  };
  expect_scene(Colloid{}, "stepped");
  expect_scene(TiledColloid{}, "tiled");
}

TEST(GoldenModels, ColloidTileByTile) {
  TiledColloid model;
  model.disks = {.count = 5000, .packing_fraction = 0.6, .start = StartKind::triangular};
  expect_golden("crowd", model, walls, 40);
}

TEST(GoldenModels, TheTableHasNoRowsOfScenesThatAreGone) {
  HashTable("models.csv")
      .expect_only({{"vicsek", "flocking"},
                    {"boids", "flocking"},
                    {"walls", "epidemic"},
                    {"periodic", "epidemic"},
                    {"every_event", "catalyst"},
                    {"crowd", "colloid_tiled"}});
}

}  // namespace
}  // namespace gridlock
