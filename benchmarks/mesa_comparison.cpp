// Models of the public comparison of agent frameworks in C++, for mesa_comparison.py: prints the milliseconds of
// processor time to make and run a model, given its name and a seed.

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "measure.hpp"
#include "models/flocking.hpp"
#include "models/predation.hpp"
#include "models/segregation.hpp"

namespace gridlock::benchmark {
namespace {

template <class Model>
void measure(Model const& model, Box const& box, std::uint64_t steps, std::uint64_t seed) {
  auto const run = [&] {
    World<Model> world{.box = box, .seed = seed};
    start_agents(model, world);
    ModelEngine<Model>(model, box, {}).advance(world, {.step = steps});
  };
  run();  // The other programs have run before, too.
  double const began = processor_seconds();
  run();
  std::printf("%.4f\n", 1000.0 * (processor_seconds() - began));
}

Flocking boids(std::uint64_t count, double radius) {
  return {.count = count, .rule = FlockingRule::boids, .radius = radius, .speed = 1.0};
}

int measure(std::string const& name, std::uint64_t seed) {
  Box const walls(1.0, 1.0, Edge::wall);
  if (name == "schelling small") {
    measure(Segregation{}, walls, 20, seed);
  } else if (name == "schelling large") {
    measure(Segregation{.side = 100, .count = 8000, .radius = 2, .wanted = 8}, walls, 20, seed);
  } else if (name == "wolf_sheep small") {
    measure(Predation{}, walls, 100, seed);
  } else if (name == "wolf_sheep large") {
    Predation const large{
        .side = 100, .sheep = 1000, .wolves = 500, .regrowth = 10, .sheep_birth = 0.4, .wolf_birth = 0.2};
    measure(large, walls, 100, seed);
  } else if (name == "flocking small") {
    measure(boids(200, 5.0), Box(100.0, 100.0, Edge::periodic), 100, seed);
  } else if (name == "flocking large") {
    measure(boids(400, 15.0), Box(150.0, 150.0, Edge::periodic), 100, seed);
  } else {
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int count, char** values) {
  return count == 3 ? gridlock::benchmark::measure(values[1], std::strtoull(values[2], nullptr, 10)) : 2;
}
