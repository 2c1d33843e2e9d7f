// The bits of the shipped models and of the paper's rule tile by tile, for ever, on 1, 2, 3 and 8 threads.
// hashes_test.cpp says how to accept others.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>

#include "golden/model_scenes.hpp"
#include "golden/table.hpp"
#include "gridlock/model/detail/on_device.hpp"
#include "model_on_ranks.hpp"
#include "models/catalyst.hpp"
#include "models/predation.hpp"
#include "models/segregation.hpp"
#include "tiled_colloid.hpp"

namespace gridlock {
namespace {

using golden::hashes_of;
using golden::periodic;
using golden::walls;

template <class Model>
void expect_golden(std::string const& scene, Model const& model, Box const& box, std::uint64_t steps) {
  Hashes const now = hashes_of(model, box, steps, {.threads = 1});
  for (std::uint64_t const threads : {2, 3, 8}) {
    EXPECT_EQ(hashes_of(model, box, steps, {.threads = threads}).end, now.end) << threads << " threads";
  }
  HashTable("models.csv").expect({scene, std::string(Model::name)}, now);
}

TEST(GoldenModels, ThoseThatRanksCanShare) {
  golden::for_each_shared_scene([](std::string const& scene, auto const& model, Box const& box, std::uint64_t steps) {
    expect_golden(scene, model, box, steps);
  });
}

TEST(GoldenModels, ThoseOnRanksHaveTheSameBits) {
  for (std::size_t const ranks : {2U, 3U, 6U}) {
    golden::for_each_shared_scene(
        [&](std::string const& scene, auto const& model, Box const& box, std::uint64_t steps) {
          SCOPED_TRACE(scene + ", " + std::to_string(ranks) + " ranks");
          Hashes const on_ranks = hashes_of(model, box, [&](auto& world) {
            world = test::advance_on_ranks(model, std::move(world), {.step = steps}, ranks, 1).world;
          });
          HashTable("models.csv").expect({scene, std::string(std::remove_cvref_t<decltype(model)>::name)}, on_ranks);
        });
  }
}

TEST(GoldenModels, ThoseOnADeviceHaveTheSameBits) {
  if (!find_device()) GTEST_SKIP() << "there is no graphics processor";
  golden::for_each_shared_scene(
      [&]<class Model>(std::string const& scene, Model const& model, Box const& box, std::uint64_t steps) {
        if constexpr (runs_on_device<Model>()) {
          for (std::uint64_t const threads : {1, 3}) {
            SCOPED_TRACE(scene + ", " + std::to_string(threads) + " threads of a device");
            Hashes const on_device = hashes_of(model, box, [&](World<Model>& world) {
              Counters unused;
              model_engine_on_device(model, box, {.threads = threads})->advance(world, unused, {.step = steps});
            });
            HashTable("models.csv").expect({scene, std::string(Model::name)}, on_device);
          }
        }
      });
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

TEST(GoldenModels, OnTheCellsOfAField) {
  expect_golden("meadow", Predation{}, walls, 60);
  expect_golden("endless_meadow", Predation{.side = 30, .sheep = 200, .regrowth = 10}, Box(2.0, 1.0, Edge::periodic),
                60);
  expect_golden("city", Segregation{.count = 900, .radius = 2, .wanted = 9}, Box(2.0, 1.5, Edge::wall), 10);
}

TEST(GoldenModels, ColloidInTheScenePaperOfTheEngines) {
  // The scene of the engines: the same start, and 0.5 in time, which their table measures in steps of this length.
  auto const expect_scene = [](auto model, std::string const& engine, auto advance) {
    model.disks = {.count = 841, .packing_fraction = 0.7};
    Hashes const now = hashes_of(model, walls, [&](auto& world) { advance(model, world); });
    HashTable("hashes.csv").expect({"paper", engine}, now);
  };
  auto const in_one_process = [](auto const& model, auto& world) {
    ModelEngine<std::remove_cvref_t<decltype(model)>>(model, walls, {.threads = 2}).advance(world, {.time = 0.5});
  };
  expect_scene(Colloid{}, "stepped", in_one_process);
  expect_scene(TiledColloid{}, "tiled", in_one_process);
  for (std::size_t const ranks : {2U, 4U}) {
    expect_scene(TiledColloid{}, "tiled", [&](TiledColloid const& model, World<TiledColloid>& world) {
      world = test::advance_on_ranks(model, std::move(world), {.time = 0.5}, ranks, 1).world;
    });
  }
}

TEST(GoldenModels, TheTableHasNoRowsOfScenesThatAreGone) {
  HashTable("models.csv")
      .expect_only({{"vicsek", "flocking"},
                    {"boids", "flocking"},
                    {"walls", "epidemic"},
                    {"periodic", "epidemic"},
                    {"every_event", "catalyst"},
                    {"meadow", "predation"},
                    {"endless_meadow", "predation"},
                    {"city", "segregation"},
                    {"crowd", "colloid_tiled"}});
}

}  // namespace
}  // namespace gridlock
