// Agents on an emulated device: which steps the device takes, and which it leaves to the cores.

#include "device/agents.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "gridlock/model/detail/cells_of_step.hpp"
#include "gridlock/model/model_engine.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock {
namespace {

template <class Model>
World<Model> started(Model const& model, Box const& box) {
  World<Model> world{.box = box, .seed = 5};
  start_agents(model, world);
  return world;
}

/// Returns the steps of `steps` that the device takes by itself, and expects the bits and events of the cores after
/// them; it ends at the first that it leaves.
template <class Model>
std::uint64_t steps_on_device(Model const& model, World<Model> world, std::uint64_t steps) {
  World<Model> expected = world;
  device::Launcher launcher(2);
  CellsOfStep const cells = cells_of_step(world.box, model.cutoff(), world.agents.size());
  device::Agents<Model> agents(launcher, model, world, cells);
  std::uint64_t taken = 0;
  while (taken < steps && agents.take_step(world, model.time_step())) {
    ++taken;
    ++world.clock.step;
    world.clock.time += model.time_step();
  }
  agents.download(world);
  ModelEngine<Model>(model, world.box, {}).advance(expected, {.step = taken});
  EXPECT_EQ(hash(world), hash(expected));
  EXPECT_EQ(world.events, expected.events);
  return taken;
}

template <class Model>
std::uint64_t steps_on_device(Model const& model, Box const& box, std::uint64_t steps) {
  return steps_on_device(model, started(model, box), steps);
}

TEST(AgentsOnDevice, FlockInEveryBox) {
  for (Edge const x : {Edge::wall, Edge::periodic}) {
    for (Edge const y : {Edge::wall, Edge::periodic}) {
      Box const box(12.0, 9.0, x, y);
      EXPECT_EQ(steps_on_device(Flocking{.count = 600}, box, 40), 40U);
      EXPECT_EQ(
          steps_on_device(Flocking{.count = 300, .rule = FlockingRule::boids, .radius = 2.0, .speed = 0.5}, box, 40),
          40U);
    }
  }
}

TEST(AgentsOnDevice, FallIllAndRecover) {
  Epidemic const epidemic{.count = 3000, .infected_at_start = 0.05, .radius = 0.02, .recovery_rate = 1.0};
  for (Edge const edge : {Edge::wall, Edge::periodic}) {
    EXPECT_EQ(steps_on_device(epidemic, Box(1.0, 1.0, edge), 60), 60U);
  }
}

TEST(AgentsOnDevice, AreLeftToTheCoresWhereSomeAreBornOrDie) {
  Epidemic const epidemic{.count = 500, .radius = 0.02, .turnover_rate = 0.2};
  EXPECT_LT(steps_on_device(epidemic, Box(1.0, 1.0, Edge::periodic), 60), 60U);
}

TEST(AgentsOnDevice, AreLeftToTheCoresWhereTheyCrowdInPartOfTheBox) {
  Flocking const flocking{.count = 500, .radius = 0.1, .speed = 0.001};
  World<Flocking> world = started(flocking, Box(50.0, 50.0, Edge::periodic));
  EXPECT_EQ(steps_on_device(flocking, world, 3), 3U);
  for (double& x : world.agents.column<X>()) x *= 0.02;
  for (double& y : world.agents.column<Y>()) y *= 0.02;
  EXPECT_EQ(steps_on_device(flocking, world, 3), 0U);
}

}  // namespace
}  // namespace gridlock
