// Models of the public comparison of agent frameworks in C++, for comparisons/run.py: prints the median time to make and
// run the small and the large model of a folder of that comparison, in its form.

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "measure.hpp"
#include "models/flocking.hpp"
#include "models/predation.hpp"
#include "models/segregation.hpp"

namespace gridlock::benchmark {
namespace {

template <class Model>
void measure(char const* name, Model const& model, Box const& box, std::uint64_t steps, std::uint64_t runs) {
  std::vector<double> milliseconds;
  for (std::uint64_t seed = 0; seed <= runs; ++seed) {
    double const began = wall_seconds();
    World<Model> world{.box = box, .seed = seed};
    start_agents(model, world);
    ModelEngine<Model>(model, box, {}).advance(world, {.step = steps});
    // The first run is left out: the other programs have run before, too.
    if (seed > 0) milliseconds.push_back(1000.0 * (wall_seconds() - began));
  }
  std::ranges::sort(milliseconds);
  std::printf("GridlockCpp %s (ms): %.4f\n", name, milliseconds[milliseconds.size() / 2]);
}

Flocking boids(std::uint64_t count, double radius) {
  return {.count = count, .rule = FlockingRule::boids, .radius = radius, .speed = 1.0};
}

int measure(std::string const& folder, std::uint64_t runs) {
  Box const walls(1.0, 1.0, Edge::wall);
  if (folder == "Schelling") {
    Segregation const large{.side = 100, .count = 8000, .radius = 2, .wanted = 8};
    measure("Schelling-small", Segregation{}, walls, 20, runs);
    measure("Schelling-large", large, walls, 20, runs);
  } else if (folder == "WolfSheep") {
    Predation const large{
        .side = 100, .sheep = 1000, .wolves = 500, .regrowth = 10, .sheep_birth = 0.4, .wolf_birth = 0.2};
    measure("WolfSheep-small", Predation{}, walls, 100, runs);
    measure("WolfSheep-large", large, walls, 100, runs);
  } else if (folder == "Flocking") {
    measure("Flocking-small", boids(200, 5.0), Box(100.0, 100.0, Edge::periodic), 100, runs);
    measure("Flocking-large", boids(400, 15.0), Box(150.0, 150.0, Edge::periodic), 100, runs);
  } else {
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace gridlock::benchmark

int main(int count, char** values) {
  std::uint64_t const runs = count == 3 ? std::strtoull(values[2], nullptr, 10) : 0;
  return runs > 0 ? gridlock::benchmark::measure(values[1], runs) : 2;
}
