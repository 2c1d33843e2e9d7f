// A model with fields: grazers eat grass, which grows again, and follow the scent that others leave.
#include <algorithm>
#include <cstdio>
#include <numeric>

#include "gridlock/simulation/model_simulation.hpp"
#include "gridlock/simulation/run.hpp"

using namespace gridlock;

struct Energy {
  using type = double;
  static constexpr char const* name = "energy";
};
struct Grass {  // a field: its name in files and pictures
  static constexpr std::string_view name = "grass";
};
struct Scent {
  static constexpr std::string_view name = "scent";
};

struct Grazers {
  static constexpr std::string_view name = "grazers";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 2> events{"born", "starved"};
  using Agents = Population<X, Y, Energy>;
  using Fields = FieldSet<Grass, Scent>;

  std::size_t columns(Grass) const { return 100; }
  std::size_t columns(Scent) const { return 50; }
  double cutoff() const { return 0.05; }
  double time_step() const { return 1.0; }

  void start(World<Grazers>& world) const {
    std::ranges::fill(field_of<Grass>(world).values(), 1.0);
    for (std::uint64_t n = 0; n < 500; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, 1.0);
    }
  }
  void turn(Turn<Grazers>& self) const {
    self.take<Grass, Energy>(0.25);
    self.deposit<Scent>(0.1);
    double const energy = self.get<Energy>() - 0.1;
    self.set<Energy>(energy);
    if (energy < 0.0) {
      self.die();
      self.count(1);
    } else if (energy > 2.0) {
      self.set<Energy>(0.5 * energy);
      self.give_birth(self.position().x, self.position().y, 0.5 * energy);
      self.count(0);
    }
    RandomStream random = self.random();
    Vector const step = 0.02 * random.in_unit_disk();
    bool const follows = self.at<Scent>(self.position() + step) >= self.at<Scent>(self.position() - step);
    self.move_by((follows ? 1.0 : -1.0) * step);
  }
  void step_fields(FieldsOfStep<Grazers>& fields) const {
    for (double& grass : fields.get<Grass>().values()) grass = std::min(grass + 0.02, 1.0);
    fields.spread<Scent>({.diffusion = 1e-4, .decay = 0.1});
  }
  void observe(World<Grazers> const& world, Observations& seen) const {
    auto const grass = field_of<Grass>(world).values();
    seen.add("grass", std::accumulate(grass.begin(), grass.end(), 0.0) / static_cast<double>(grass.size()));
  }
};

int main() {
  ModelSimulation<Grazers> grazers({}, Box(1.0, 1.0, Edge::periodic), 1, {.threads = 2});
  Run run(grazers, {.stop_condition = {.step = 200}, .sample_every = 50});
  run.advance();
  RunRecord const record = run.record();
  for (std::size_t k = 0; k < record.series.row_count(); ++k) {
    std::printf("step %3.0f: %4.0f grazers, grass %.4f\n", record.series.numbers("step")[k],
                record.series.numbers("agents")[k], record.series.numbers("grass")[k]);
  }
}
