// One birth and one death at random places among 10⁶ agents: population and grid together, in whole steps of a model,
// and the memory that 10⁸ of each leave behind.

#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/core/random.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/model/model.hpp"
#include "measure.hpp"

namespace gridlock::benchmark {
namespace {

struct Points {
  static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<X, Y>;
};

constexpr double side = 1000.0;
constexpr double cutoff = 1.4;

/// Agents of which in each step a share dies and as many are born, anywhere; the same random numbers are drawn where it
/// is zero.
struct InTurns {
  static constexpr std::string_view name = "in turns";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  double share = 0.0;
  double cutoff() const { return benchmark::cutoff; }
  double time_step() const { return 1.0; }
  void turn(Turn<InTurns>& self) const {
    RandomStream random = self.random();
    double const x = side * random.uniform();
    double const y = side * random.uniform();
    if (random.uniform() < share) self.give_birth(x, y);
    if (random.uniform() < share) self.die();
  }
};

/// The same where a model carries the whole world through a step: one agent of each range of rows dies.
struct AsEvents {
  static constexpr std::string_view name = "as events";
  static constexpr Schedule schedule = Schedule::events;
  using Agents = Population<X, Y>;
  double share = 0.0;
  double cutoff() const { return benchmark::cutoff; }
  double time_step() const { return 1.0; }
  void step(MutableWorld<AsEvents>& open) const {
    auto const events = static_cast<std::size_t>(share * static_cast<double>(open.size()));
    if (events == 0) return;
    RandomStream random = open.random();
    std::size_t const range = open.size() / events;
    std::vector<Id> dying(events);
    std::vector<Agents::Values> newborn(events);
    for (std::size_t k = 0; k < events; ++k) dying[k] = open.agent_in_row(k * range + random.below(range));
    for (auto& values : newborn) values = {side * random.uniform(), side * random.uniform()};
    open.remove_all(dying);
    open.add_all(newborn);
  }
};

/// Four steps in which a tenth of the agents die and as many are born, besides the same in which nobody does.
template <class Model>
void race_in_steps(std::size_t agents) {
  auto const contestant = [&](std::string name, double share) {
    Box const box(side, side, Edge::periodic);
    auto const world = std::make_shared<World<Model>>(World<Model>{.box = box, .seed = 1});
    for (std::size_t n = 0; n < agents; ++n) {
      RandomStream random = world->start_random(n);
      Vector const p = world->anywhere(random);
      world->agents.add(p.x, p.y);
    }
    auto const engine = std::make_shared<ModelEngine<Model>>(Model{.share = share}, box, ModelEngineSettings{});
    return Contestant{.name = std::string(Model::name) + ", " + std::move(name),
                      .items = 4.0 * static_cast<double>(agents),
                      .run = [=] { engine->advance(*world, {.step = world->clock.step + 4}); },
                      .result = [=] { return hash(*world); }};
  };
  race("population_steps", agents, 0.0, 6, {contestant("nobody born", 0.0), contestant("a tenth born and dead", 0.1)});
}

/// A fast generator of its own, so that the drawing of places is no part of what is measured.
struct Places {
  std::uint64_t word = 88172645463325252ULL;
  std::uint64_t next() {
    word ^= word << 13;
    word ^= word >> 7;
    word ^= word << 17;
    return word;
  }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
};

/// Kibibytes of memory in use.
double resident() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    double kibibytes = 0.0;
    if (word == "VmRSS:" && file >> kibibytes) return kibibytes;
  }
  return 0.0;
}

}  // namespace
}  // namespace gridlock::benchmark

int main() {
  using namespace gridlock;
  using namespace gridlock::benchmark;
  constexpr std::size_t agents = 1'000'000;
  World<Points> world{.box = Box(side, side, Edge::periodic), .seed = 1};
  PackedGrid grid(layout_for_cutoff(world.box, cutoff, agents));
  MutableWorld<Points> open(world, grid, cutoff, false);
  Places places;
  for (std::size_t n = 0; n < agents; ++n) open.add(side * places.uniform(), side * places.uniform());
  auto const churn = [&](std::size_t times) {
    for (std::size_t k = 0; k < times; ++k) {
      open.remove(open.agent_in_row(places.next() % agents));
      open.add(side * places.uniform(), side * places.uniform());
    }
  };
  // The same deaths and births, a thousand of each known at a time.
  std::vector<Id> dying(1000);
  std::vector<Points::Agents::Values> newborn(dying.size());
  auto const churn_known = [&](std::size_t times) {
    for (std::size_t k = 0; k < times; k += dying.size()) {
      // One of every thousandth of the rows, so that nobody is drawn twice.
      for (std::size_t n = 0; n < dying.size(); ++n) {
        dying[n] = open.agent_in_row(n * (agents / dying.size()) + places.next() % (agents / dying.size()));
      }
      for (auto& values : newborn) values = {side * places.uniform(), side * places.uniform()};
      open.remove_all(dying);
      open.add_all(newborn);
    }
  };
  print_header();
  race("population", agents, 0.0, 6,
       {{.name = "one birth and one death",
         .items = 1e6,
         .run = [&] { churn(1'000'000); },
         .result = [&] { return hash(world); }},
        {.name = "a thousand known beforehand",
         .items = 1e6,
         .run = [&] { churn_known(1'000'000); },
         .result = [&] { return hash(world); }}});
  race_in_steps<InTurns>(agents);
  race_in_steps<AsEvents>(agents);
  double const before = resident();
  churn_known(100'000'000);
  std::printf("# memory before and after 1e8 births and deaths: %.1f and %.1f MiB\n", before / 1024.0,
              resident() / 1024.0);
}
