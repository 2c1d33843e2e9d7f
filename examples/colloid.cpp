// The paper's rule for hard disks as a model on one page, colloid.hpp: it takes every disk to the same bits as the
// engine.
#include "colloid.hpp"

#include <cstdint>
#include <cstdio>

#include "gridlock/engine/engine.hpp"

using namespace gridlock;

Box const box(1.25, 0.8, Edge::wall);
constexpr std::uint64_t seed = 1;
constexpr double time_to_reach = 20.0;

std::uint64_t by_model(Colloid const& model) {
  World<Colloid> world{.box = box, .seed = seed};
  start_agents(model, world);
  ModelEngine<Colloid>(model, box, {}).advance(world, {.time = time_to_reach});
  return hash(world);
}

std::uint64_t by_engine(Colloid const& model) {
  State state = make_start(box, model.disks, seed);
  draw_velocities(state, model.velocities);
  Counters counters;
  make_engine({.kind = "stepped", .time_step = model.step_length}, state)
      ->advance(state, counters, {.time = time_to_reach});
  return hash(state);
}

int main() {
  Colloid const model;
  std::printf("state hash of the model   %016llx\n", static_cast<unsigned long long>(by_model(model)));
  std::printf("state hash of the engine  %016llx\n", static_cast<unsigned long long>(by_engine(model)));
}
