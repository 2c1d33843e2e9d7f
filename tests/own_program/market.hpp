// A model whose agents take turns tile by tile, as a user would write it.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "gridlock/simulation/register_model.hpp"

using namespace gridlock;

struct Coins {
  using type = std::uint32_t;
  static constexpr char const* name = "coins";
};

/// Agents that hand coins to their neighbours, have children when they are rich and die when they are poor; some fly
/// anywhere.
struct Market {
  static constexpr std::string_view name = "market";
  static constexpr std::string_view documentation = "Agents that hand coins to their neighbours.";
  static constexpr Schedule schedule = Schedule::tiled;
  static constexpr std::array<std::string_view, 2> events{"gifts", "flights"};
  using Agents = Population<X, Y, Coins>;

  std::uint64_t count = 2000;
  double flights = 0.002;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "count", .documentation = "Agents at the start.", .min = 1, .max = 1e6}, count);
    visitor.visit({.key = "flights", .documentation = "Share of agents that fly in a step.", .min = 0, .max = 1},
                  flights);
  }
  double cutoff() const { return 0.02; }
  double time_step() const { return 1.0; }
  void start(World<Market>& world) const {
    for (std::uint64_t n = 0; n < count; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(p.x, p.y, static_cast<std::uint32_t>(random.below(4)));
    }
  }
  bool is_local(Turn<Market> const& self, double /*room*/) const { return self.random(1).uniform() >= flights; }
  void turn(Turn<Market>& self) const {
    RandomStream random = self.random();
    if (is_local(self, 0.0)) {
      self.move_by(cutoff() * random.in_unit_disk());
    } else {
      double const x = random.uniform() * self.box().width();
      self.move_to({x, random.uniform() * self.box().height()});
      self.count(1);
    }
    self.for_each_neighbour(cutoff(), [&](Neighbour<Market> const& other) {
      if (self.get<Coins>() <= other.get<Coins>()) return;
      self.set<Coins>(self.get<Coins>() - 1);
      other.set<Coins>(other.get<Coins>() + 1);
      self.count(0);
    });
    if (self.get<Coins>() > 3) {
      self.set<Coins>(self.get<Coins>() - 2);
      self.give_birth(self.position().x, self.position().y, 2U);
    } else if (self.get<Coins>() == 0 && random.below(20) == 0) {
      self.die();
    }
  }
  void observe(AgentSums<Market> const& agents, Observations& seen) const {
    double const coins = agents.sum([](auto const& agent) { return static_cast<double>(agent.template get<Coins>()); });
    seen.add("coins", coins, "Coins of all agents.");
  }
};
