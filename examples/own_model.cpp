// A model in one file: a rumour among people who walk about. Whoever is near someone who knows it, hears it.
#include <cstdio>

#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/run.hpp"

using namespace gridlock;

struct Knows {  // a column: its type and its name in files
  using type = std::uint32_t;
  static constexpr char const* name = "knows";
};

struct Rumour {
  static constexpr std::string_view name = "rumour";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 1> events{"tellings"};
  using Agents = Population<X, Y, Knows>;

  double cutoff() const { return 0.05; }
  double time_step() const { return 1.0; }
  std::uint64_t agents_at_start() const { return 500; }
  Agents::Values first_agent(World<Rumour> const& world, std::uint64_t number) const {
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    return {p.x, p.y, number == 0 ? 1U : 0U};
  }
  void turn(Turn<Rumour>& self) const {
    bool hears = false;
    self.for_each_neighbour(cutoff(), [&](Neighbour<Rumour> const& other) { hears |= other.get<Knows>() == 1; });
    if (hears && self.get<Knows>() == 0) {
      self.set<Knows>(1);
      self.count(0);
    }
    RandomStream random = self.random();
    self.move_by(0.02 * random.in_unit_disk());
  }
  void observe(AgentSums<Rumour> const& agents, Observations& seen) const {
    seen.add_counts<Knows>(agents, {"ignorant", "informed"});
  }
};

int main() {
  ModelSimulation<Rumour> simulation({}, Box(1.0, 1.0, Edge::periodic), 1, {.threads = 2, .verify_every = 10});
  Run run(simulation, {.stop_condition = {.step = 200}, .sample_every = 10});
  run.advance();
  std::printf("%g of 500 know; state hash %016llx\n", run.record().series.numbers("informed").back(),
              static_cast<unsigned long long>(simulation.state_hash()));
}
