// A model with a network: the flu spreads among friends, wherever these are, and who avoids the ill loses friends.
#include <cstdio>

#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/run.hpp"

using namespace gridlock;

struct Health {
  using type = std::uint32_t;
  static constexpr char const* name = "health";
  static constexpr std::array<std::string_view, 3> value_names{"spared", "ill", "recovered"};
};
struct Friends {  // a network: its name in files
  static constexpr std::string_view name = "friends";
};

struct Flu {
  static constexpr std::string_view name = "flu";
  static constexpr Schedule schedule = Schedule::synchronous;
  enum : std::uint32_t { spared, ill, recovered };
  using Agents = Population<X, Y, Health>;
  using Networks = NetworkSet<Friends>;
  double avoidance = 0.0;  // share of the edges to the ill that are lost in a step

  double cutoff() const { return 0.05; }
  double time_step() const { return 1.0; }
  std::uint64_t agents_at_start() const { return 5000; }
  Agents::Values first_agent(World<Flu> const& world, std::uint64_t number) const {
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    return {p.x, p.y, number % 500 == 0 ? ill : spared};
  }
  void start_networks(World<Flu>& world) const {
    RandomStream random = start_random_of_network<Friends>(world);
    NodePairs const pairs = small_world_graph(5000, {.degree = 6, .rewiring = 0.2}, random);
    network_of<Friends>(world).connect(edges_of(pairs, world.agents.ids()));
  }
  void turn(Turn<Flu>& self) const {
    RandomStream random = self.random();
    if (self.get<Health>() == ill && random.uniform() < 0.1) self.set<Health>(recovered);
    if (self.get<Health>() != spared) return;
    self.for_each_neighbour<Friends>([&](Neighbour<Flu> const& other, double weight) {
      if (other.get<Health>() == ill && random.uniform() < 0.05 * weight) self.set<Health>(ill);
    });
  }
  void step_networks(NetworksOfStep<Flu>& networks) const {
    World<Flu> const& world = networks.world();
    RandomStream random = networks.random<Friends>();
    auto const is_ill = [&](Id id) { return world.agents.column<Health>()[world.agents.index_of(id)] == ill; };
    std::vector<NetworkEdge> lost;
    for (NetworkEdge const& edge : network_of<Friends>(world).edges()) {
      if (is_ill(edge.from) != is_ill(edge.to) && random.uniform() < avoidance) lost.push_back(edge);
    }
    networks.get<Friends>().disconnect(lost);
  }
  void observe(World<Flu> const& world, Observations& seen) const {
    seen.add_counts<Health>(world.agents);
    auto const people = static_cast<double>(world.agents.size());
    seen.add("friends", 2.0 * static_cast<double>(network_of<Friends>(world).size()) / people);
  }
};

int main() {
  for (double const avoidance : {0.0, 0.1}) {
    ModelSimulation<Flu> flu({.avoidance = avoidance}, Box(1.0, 1.0, Edge::periodic), 1, {.threads = 2});
    Run run(flu, {.stop_condition = {.step = 400}, .sample_every = 400});
    run.advance();
    RunRecord const record = run.record();
    std::printf("avoidance %.1f: %4.0f are spared, with %.2f friends each\n", avoidance,
                record.series.numbers("spared").back(), record.series.numbers("friends").back());
  }
}
