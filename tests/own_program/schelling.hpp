// A model as a user would write it.
#pragma once

#include <cstdint>
#include <string_view>

#include "gridlock/simulation/register_model.hpp"

using namespace gridlock;

struct Side {
  using type = std::uint32_t;
  static constexpr char const* name = "side";
};

/// Agents of two sides that move on where too few of their own side are near.
struct Schelling {
  static constexpr std::string_view name = "schelling";
  static constexpr std::string_view documentation = "Agents of two sides that move away from the other side.";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 1> events{"moves"};
  using Agents = Population<X, Y, Side>;

  std::uint64_t count = 200;
  double tolerance = 0.5;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "count", .documentation = "Agents.", .min = 1, .max = 1e6}, count);
    visitor.visit({.key = "tolerance", .documentation = "Share of others an agent bears.", .min = 0, .max = 1},
                  tolerance);
  }
  double cutoff() const { return 0.1; }
  double time_step() const { return 1.0; }
  void start(World<Schelling>& world) const {
    for (std::uint64_t n = 0; n < count; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, static_cast<std::uint32_t>(n % 2));
    }
  }
  void turn(Turn<Schelling>& self) const {
    double all = 0.0;
    double others = 0.0;
    self.for_each_neighbour(cutoff(), [&](Neighbour<Schelling> const& other) {
      all += 1.0;
      if (other.get<Side>() != self.get<Side>()) others += 1.0;
    });
    if (others <= tolerance * all) return;
    RandomStream random = self.random();
    self.move_by(0.1 * random.in_unit_disk());
    self.count(0);
  }
  void observe(AgentSums<Schelling> const& agents, Observations& seen) const {
    seen.add_counts<Side>(agents, {"left", "right"});
  }
};
