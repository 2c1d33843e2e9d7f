// A model that reads a column which its agents do not have. It must not compile; run.cmake looks at the error.

#include "gridlock/model/model.hpp"

using namespace gridlock;

struct Hunger {
  using type = double;
  static constexpr char const* name = "hunger";
};

struct Grazing {
  static constexpr std::string_view name = "grazing";
  static constexpr Schedule schedule = Schedule::synchronous;
  using Agents = Population<X, Y>;
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Grazing>& world) const { world.agents.add(0.5, 0.5); }
  void turn(Turn<Grazing>& self) const {
    if (self.get<Hunger>() > 1.0) self.die();
  }
};

void run(World<Grazing>& world) { ModelEngine<Grazing>(Grazing{}, world.box, {}).advance(world, {.step = 1}); }
