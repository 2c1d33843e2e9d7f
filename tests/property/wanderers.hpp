// A synchronous model that does all that a model may do.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "model_on_ranks.hpp"

namespace gridlock::test {

struct Weight {
  using type = double;
  static constexpr char const* name = "weight";
};

/// Synchronous agents that do all that a model may do: they wander, some jump anywhere; they have children beside them
/// and far away, die, and kill their neighbours, so that births, deaths and moves come to lie on cuts and in rims of
/// all ranks.
struct Wanderers {
  static constexpr std::string_view name = "wanderers_of_test";
  static constexpr std::string_view documentation = "Agents that do all that a model may do.";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 4> events{"jumps", "births", "deaths", "kills"};
  using Agents = Population<X, Y, Weight>;

  std::uint64_t count = 500;
  double radius = 0.1;
  double speed = 0.05;
  double jump = 0.0;  ///< probabilities
  double birth = 0.0;
  double far_birth = 0.0;
  double death = 0.0;
  double kill = 0.0;
  double crowd = 1.0;  ///< the part of each side where agents start
  std::uint64_t fails_at = 1'000'000;
  std::uint64_t failing_agents = 1;

  void describe(SettingVisitor& visitor) {
    visitor.visit({.key = "count"}, count);
    for (auto& [key, value] : {std::pair("radius", &radius), std::pair("speed", &speed), std::pair("jump", &jump),
                               std::pair("birth", &birth), std::pair("far_birth", &far_birth),
                               std::pair("death", &death), std::pair("kill", &kill), std::pair("crowd", &crowd)}) {
      visitor.visit({.key = key}, *value);
    }
    visitor.visit({.key = "fails_at"}, fails_at);
    visitor.visit({.key = "failing_agents"}, failing_agents);
  }
  [[nodiscard]] double cutoff() const { return radius; }
  [[nodiscard]] double time_step() const { return 0.1; }

  void start(World<Wanderers>& world) const {
    for (std::uint64_t n = 0; n < count; ++n) {
      RandomStream random = world.start_random(n);
      Vector const p = world.anywhere(random);
      world.agents.add(crowd * p.x, crowd * p.y, random.uniform());
    }
  }

  void turn(Turn<Wanderers>& self) const {
    RandomStream random = self.random();
    double sum = self.get<Weight>();
    double const luck = random.uniform();
    // Sums round in the order of the neighbours.
    self.for_each_neighbour(radius, [&](Neighbour<Wanderers> const& other) {
      sum += 0.3 * other.get<Weight>() + 0.01 * other.separation().x;
      if (luck < kill && other.id() % 3 == 0) {
        other.kill();
        self.count(3);
      }
    });
    self.set<Weight>(sum / (1.0 + sum * sum) + 1e-3 * static_cast<double>(self.population()));
    if (random.uniform() < jump) {
      double const x = random.uniform() * self.box().width();
      self.move_to({x, random.uniform() * self.box().height()});
      self.count(0);
    } else {
      self.move_by(speed * random.in_unit_disk());
    }
    come_and_go(self, random);
    if (self.clock().step == fails_at && self.id() % 101 < failing_agents) {
      throw std::runtime_error("agent " + std::to_string(self.id()) + " fails");
    }
  }

 private:
  void come_and_go(Turn<Wanderers>& self, RandomStream& random) const {
    while (random.uniform() < birth) {
      self.give_birth(self.position().x, self.position().y, random.uniform());
      self.count(1);
    }
    if (random.uniform() < far_birth) {
      double const x = random.uniform() * self.box().width();
      self.give_birth(x, random.uniform() * self.box().height(), random.uniform());
      self.count(1);
    }
    if (random.uniform() < death) {
      self.die();
      self.count(2);
    }
  }
};

using KnownModels = KnownModel<Wanderers>;

}  // namespace gridlock::test
