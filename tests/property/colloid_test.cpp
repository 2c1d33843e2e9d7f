// The paper's disks as a model take the turns of the engines: in the order of the Ids those of `stepped`, tile by tile
// those of `tiled`, to the last bit.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "reference/random_scene.hpp"
#include "tiled_colloid.hpp"

namespace gridlock {
namespace {

using reference::random_scene;
using reference::SceneSettings;

struct ColloidCase {
  std::string name;
  SceneSettings scene;
  double step_length = 0.1;
  std::uint64_t substeps = 5;
  double fastest = 1.0;  ///< how much faster every seventh disk is

  friend std::ostream& operator<<(std::ostream& out, ColloidCase const& c) {
    return out << c.scene << ", step length " << c.step_length << ", sub-steps " << c.substeps;
  }
};

std::vector<ColloidCase> colloid_cases() {
  SceneSettings const dense{.count = 400, .packing_fraction = 0.7};
  SceneSettings const mixture{.edge = Edge::periodic,
                              .width = 1.7,
                              .height = 0.9,
                              .count = 300,
                              .packing_fraction = 0.5,
                              .smallest_ratio = 0.3,
                              .heaviest_mass = 5.0};
  SceneSettings const many{.edge = Edge::periodic, .width = 2.0, .count = 1500, .packing_fraction = 0.6};
  std::vector<ColloidCase> all{
      {.name = "dense", .scene = dense},
      {.name = "mixture", .scene = mixture, .step_length = 0.3, .substeps = 3},
      {.name = "many", .scene = many},
      {.name = "some_fast", .scene = dense, .fastest = 12.0},
      {.name = "some_fast_around", .scene = mixture, .fastest = 6.0},
      {.name = "alone", .scene = {.count = 1, .packing_fraction = 0.05}},
      {.name = "few_around", .scene = {.edge = Edge::periodic, .count = 3, .packing_fraction = 0.1}},
  };
  for (std::uint64_t const seed : {11, 12, 13, 14}) {
    SceneSettings const random{.edge = seed % 2 == 0 ? Edge::wall : Edge::periodic,
                               .width = 0.4 * static_cast<double>(seed % 4 + 1),
                               .count = 40 * (seed - 9),
                               .smallest_ratio = 0.5,
                               .seed = seed};
    all.push_back({.name = "random_" + std::to_string(seed), .scene = random});
  }
  return all;
}

class ColloidOn : public testing::TestWithParam<ColloidCase> {
 protected:
  static constexpr std::uint64_t steps = 40;

  /// The state after the steps of the engine, and what happened in them.
  struct End {
    std::uint64_t hash;
    Counters counters;
  };

  static State start() {
    State state = random_scene(GetParam().scene);
    for (std::size_t i = 0; i < state.agents.size(); i += 7) state.agents.column<VelocityX>()[i] *= GetParam().fastest;
    return state;
  }
  static End end_of_engine(std::string const& kind, CollisionRule contact) {
    State state = start();
    EngineSettings const settings{.kind = kind,
                                  .time_step = GetParam().step_length,
                                  .speed = 1.0,
                                  .substeps = GetParam().substeps,
                                  .contact = contact,
                                  .threads = 1};
    Counters counters;
    make_engine(settings, state)->advance(state, counters, {.step = steps});
    return {hash(state), counters};
  }
  template <class Model>
  static void expect_the_same(End const& expected, CollisionRule contact, ModelEngineSettings const& settings) {
    Model model;
    model.step_length = GetParam().step_length;
    model.substeps = GetParam().substeps;
    model.contact = contact;
    State state = start();
    World<Model> world{.box = state.box, .agents = state.agents, .clock = state.clock, .seed = state.seed};
    ModelEngine<Model> engine(model, world.box, settings);
    engine.advance(world, {.step = steps / 2});
    engine.advance(world, {.step = steps});
    EXPECT_EQ(hash(world), expected.hash) << settings.threads << " threads";
    EXPECT_EQ(world.events[0], expected.counters.pair_collisions);
    EXPECT_EQ(world.events[2], expected.counters.halted_moves);
  }
};

TEST_P(ColloidOn, OneAfterTheOtherHasTheBitsOfTheEngineStepped) {
  for (CollisionRule const contact : {CollisionRule::always, CollisionRule::approaching}) {
    End const expected = end_of_engine("stepped", contact);
    EXPECT_GE(expected.counters.pair_collisions, GetParam().scene.count > 20 ? 20U : 0U) << "little happens";
    expect_the_same<Colloid>(expected, contact, {.verify_every = 13});
  }
}

TEST_P(ColloidOn, TileByTileOnAnyNumberOfThreadsHasTheBitsOfTheEngineTiled) {
  for (CollisionRule const contact : {CollisionRule::always, CollisionRule::approaching}) {
    End const expected = end_of_engine("tiled", contact);
    for (std::uint64_t const threads : {1, 2, 3, 8}) {
      expect_the_same<TiledColloid>(expected, contact, {.threads = threads, .verify_every = 13});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, ColloidOn, testing::ValuesIn(colloid_cases()),
                         [](auto const& one) { return one.param.name; });

TEST(Colloid, ADiskThatCouldJumpOverAnotherEndsTheRun) {
  Colloid model;
  model.step_length = 3.0;
  World<Colloid> world{.box = Box(1.25, 0.8, Edge::wall), .seed = 1};
  start_agents(model, world);
  ModelEngine<Colloid> engine(model, world.box, {});
  EXPECT_THROW(engine.advance(world, {.step = 100}), RunFailure);
}

/// Agents that move to the right, each as far as the others and the walls let it.
struct Queue {
  static constexpr std::string_view name = "queue";
  static constexpr Schedule schedule = Schedule::sequential;
  static constexpr std::array<std::string_view, 2> events{"partners", "walls"};
  using Agents = Population<X, Y, Radius>;
  double largest = 0.1;
  double part = 0.03;

  double cutoff() const { return 2.0 * largest; }
  double time_step() const { return 1.0; }
  void turn(Turn<Queue>& self) const {
    auto const halt = move_apart(self, {part, 0.0}, 3);
    if (halt.partner) self.count(0);
    if (halt.wall.x) self.count(1);
  }
};

World<Queue> queue(std::vector<double> const& places) {
  World<Queue> world{.box = Box(1.0, 1.0, Edge::wall)};
  for (double const x : places) world.agents.add(x, 0.5, 0.1);
  return world;
}

TEST(MoveApart, HaltsBeforeThePartThatWouldOverlap) {
  // A gap of 0.05 takes one part of 0.03, the room of 0.07 before the wall two.
  World<Queue> world = queue({0.3, 0.55, 0.83});
  ModelEngine<Queue>({}, world.box, {}).advance(world, {.step = 1});
  auto const x = world.agents.column<X>();
  EXPECT_NEAR(x[0], 0.33, 1e-12);
  EXPECT_NEAR(x[1], 0.61, 1e-12);
  EXPECT_NEAR(x[2], 0.89, 1e-12);
  EXPECT_EQ(world.events, (EventCounts<Queue>{2, 1}));
}

TEST(MoveApart, LetsAgentsThatOverlapMoveAwayFromEachOtherOnly) {
  World<Queue> world = queue({0.3, 0.4});
  ModelEngine<Queue>({}, world.box, {}).advance(world, {.step = 1});
  EXPECT_EQ(world.agents.column<X>()[0], 0.3);
  EXPECT_NEAR(world.agents.column<X>()[1], 0.49, 1e-12);
}

TEST(MoveApart, RefusesPartsThatCouldJumpAndRadiiThatSearchesDoNotReach) {
  auto const failure_of = [](Queue const& model) -> std::string {
    World<Queue> world = queue({0.3, 0.55});
    try {
      ModelEngine<Queue>(model, world.box, {}).advance(world, {.step = 1});
    } catch (RunFailure const& failure) {
      return failure.what();
    }
    return "";
  };
  EXPECT_NE(failure_of({.part = 0.1}).find("agent 0 of radius 0.1 moves by (0.1, 0) in one part and could jump"),
            std::string::npos);
  EXPECT_NE(failure_of({.largest = 0.09}).find("agent 0 has a radius of 0.1, but the model declares a cutoff of 0.18"),
            std::string::npos);
}

}  // namespace
}  // namespace gridlock
