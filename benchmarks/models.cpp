// Models: nanoseconds per agent and step, with the hash of the state reached, which must not depend on the threads; and
// the flocking of the public comparison of agent frameworks (100 steps).

#include <cmath>
#include <memory>
#include <string>

#include "measure.hpp"
#include "models/epidemic.hpp"
#include "models/flocking.hpp"

namespace gridlock::benchmark {
namespace {

/// A world carried on `steps` steps a round.
template <class Model>
Contestant contestant(std::string name, Model const& model, Box const& box, std::uint64_t threads,
                      std::uint64_t steps) {
  auto const world = std::make_shared<World<Model>>(World<Model>{.box = box, .seed = 1});
  start_agents(model, *world);
  auto const engine = std::make_shared<ModelEngine<Model>>(model, box, ModelEngineSettings{.threads = threads});
  return {.name = std::move(name),
          .items = static_cast<double>(world->agents.size() * steps),
          .run = [=] { engine->advance(*world, {.step = world->clock.step + steps}); },
          .result = [=] { return hash(*world); },
          .clock = wall_seconds};
}

/// 100 steps from the start, as the public comparison counts them: later a flock is denser.
Contestant comparison(Flocking const& model, Box const& box) {
  constexpr std::uint64_t steps = 100;
  auto const world = std::make_shared<World<Flocking>>(World<Flocking>{.box = box, .seed = 1});
  auto const run = [=] {
    *world = {.box = box, .seed = 1};
    start_agents(model, *world);
    ModelEngine<Flocking>(model, box, {}).advance(*world, {.step = steps});
  };
  return {.name = "boids, 100 steps",
          .items = static_cast<double>(model.count * steps),
          .run = run,
          .result = [=] { return hash(*world); },
          .clock = wall_seconds};
}

template <class Model>
void race_on_threads(char const* name, Model const& model, Box const& box, int rounds) {
  race(name, model.count, 0.0, rounds,
       {contestant("one thread", model, box, 1, 2), contestant("two threads", model, box, 2, 2)});
}

}  // namespace
}  // namespace gridlock::benchmark

int main() {
  using namespace gridlock;
  using namespace gridlock::benchmark;
  print_header();
  // About six neighbours each.
  double const side = std::sqrt(1e6 * std::numbers::pi / 6.0);
  race_on_threads("flocking", Flocking{.count = 1'000'000}, Box(side, side, Edge::periodic), 6);
  Epidemic const epidemic{.count = 1'000'000,
                          .infected_at_start = 0.1,
                          .radius = 1.0,
                          .speed = 1.0,
                          .infection_rate = 0.1,
                          .turnover_rate = 0.02,
                          .step_length = 0.05};
  race_on_threads("epidemic", epidemic, Box(side, side, Edge::periodic), 6);
  Flocking boids{.count = 200, .rule = FlockingRule::boids, .radius = 5.0, .speed = 1.0};
  race("comparison_small", 200, 0.0, 20, {comparison(boids, Box(100, 100, Edge::periodic))});
  boids.count = 400;
  boids.radius = 15.0;
  race("comparison_large", 400, 0.0, 20, {comparison(boids, Box(150, 150, Edge::periodic))});
}
