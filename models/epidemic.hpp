#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"
#include "gridlock/model/model.hpp"

namespace gridlock {

struct Health {
  using type = std::uint32_t;
  static constexpr char const* name = "health";
  static constexpr std::array<std::string_view, 3> value_names{"susceptible", "infected", "recovered"};
};

/// Walkers that catch a disease from infected neighbours and recover: susceptible → infected → recovered, with births
/// and deaths.
///
/// In a step of length dt a susceptible agent with k infected agents within the radius is infected with probability 1 −
/// (1 − β dt)^k, and an infected agent recovers with probability γ dt. Every agent dies with probability μ dt and has a
/// susceptible child beside it with probability μ dt, if the population is below its bound. For small dt these are
/// rates in continuous time. Where walkers mix fast, the numbers follow dS/dt = −β n S I/N …, with n = N π r²/A agents
/// within the cutoff (Kermack & McKendrick 1927, doi:10.1098/rspa.1927.0118).
struct Epidemic {
  static constexpr std::string_view name = "epidemic";
  static constexpr std::string_view documentation = "Walkers that infect those near them and recover.";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr std::array<std::string_view, 4> events{"infections", "recoveries", "births", "deaths"};
  static constexpr bool runs_on_device = true;
  enum State : std::uint32_t { susceptible, infected, recovered };
  using Agents = Population<X, Y, VelocityX, VelocityY, Health>;

  std::uint64_t count = 2000;
  double infected_at_start = 0.01;
  double radius = 0.02;
  double speed = 0.05;
  double turning_rate = 1.0;
  double infection_rate = 1.0;
  double recovery_rate = 0.2;
  double turnover_rate = 0.0;
  std::uint64_t most_agents = 10'000'000;
  double step_length = 0.05;

  void describe(SettingVisitor& visitor) {
    auto const rate = [&](std::string_view key, std::string_view text, double& value) {
      visitor.visit({.key = key, .unit = "1 / time", .documentation = text, .min = 0.0}, value);
    };
    visitor.visit({.key = "count", .documentation = "Agents at the start.", .min = 1, .max = 2e9}, count);
    visitor.visit({.key = "infected_at_start", .documentation = "Share of them.", .min = 0.0, .max = 1.0},
                  infected_at_start);
    visitor.visit({.key = "radius",
                   .unit = "length",
                   .documentation = "How far the disease reaches.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  radius);
    visitor.visit({.key = "speed",
                   .unit = "length / time",
                   .documentation = "Of every walker; a step is shorter than the box.",
                   .min = 0.0},
                  speed);
    rate("turning_rate", "How often a walker takes a new direction.", turning_rate);
    rate("infection_rate", "β, for each infected agent within the radius.", infection_rate);
    rate("recovery_rate", "γ, of each infected agent.", recovery_rate);
    rate("turnover_rate", "μ: births and deaths, each, of each agent.", turnover_rate);
    visitor.visit({.key = "most_agents", .documentation = "Above this number no agent is born.", .min = 1, .max = 2e9},
                  most_agents);
    visitor.visit({.key = "step_length",
                   .unit = "time",
                   .documentation = "dt; every rate times dt is a probability, at most 1, and should be small.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  step_length);
  }
  void check(Box const& box) const {
    // Without room for births the population would only shrink, because deaths continue.
    if (turnover_rate > 0.0 && most_agents < count) {
      throw Error({.what = "most_agents = " + std::to_string(most_agents) +
                           " is below count = " + std::to_string(count) + ", the agents at the start",
                   .hint = "use a most_agents of " + std::to_string(count) + " or more",
                   .key = "most_agents"});
    }
    require_displacement(box, speed * step_length, "speed");
    require_probability("turning_rate", turning_rate);
    require_probability("infection_rate", infection_rate);
    require_probability("recovery_rate", recovery_rate);
    require_probability("turnover_rate", turnover_rate);
  }
  [[nodiscard]] std::uint64_t agents_at_start() const { return count; }

  [[nodiscard]] double cutoff() const { return radius; }
  [[nodiscard]] double time_step() const { return step_length; }

  [[nodiscard]] Agents::Values first_agent(World<Epidemic> const& world, std::uint64_t number) const {
    auto const sick = static_cast<std::uint64_t>(infected_at_start * static_cast<double>(count) + 0.5);
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    Vector const v = speed * direction(2.0 * std::numbers::pi * random.uniform());
    return {p.x, p.y, v.x, v.y, number < sick ? infected : susceptible};
  }

  constexpr void turn(auto& self) const {
    auto random = self.random();
    std::uint32_t const health = self.template get<Health>();
    if (health == susceptible) {
      meet_others(self, random);
    } else if (health == infected && random.uniform() < recovery_rate * step_length) {
      self.template set<Health>(recovered);
      self.count(1);
    }
    walk(self, random);
    if (turnover_rate > 0.0) come_and_go(self, random);
  }

  void observe(AgentSums<Epidemic> const& agents, Observations& seen) const { seen.add_counts<Health>(agents); }

 private:
  void require_probability(std::string const& key, double rate) const {
    if (rate * step_length <= 1.0) return;
    throw Error(
        {.what = key + " · step_length is " + in_words(rate * step_length) + ", but is a probability and at most 1",
         .hint = "use a smaller step_length or a smaller rate",
         .key = key});
  }

  constexpr void meet_others(auto& self, auto& random) const {
    double escape = 1.0;
    self.for_each_neighbour(radius, [&](auto const& other) {
      if (other.template get<Health>() == infected) escape *= 1.0 - infection_rate * step_length;
    });
    if (escape < 1.0 && random.uniform() >= escape) {
      self.template set<Health>(infected);
      self.count(0);
    }
  }

  constexpr void walk(auto& self, auto& random) const {
    Vector v{self.template get<VelocityX>(), self.template get<VelocityY>()};
    if (random.uniform() < turning_rate * step_length) v = speed * direction(2.0 * std::numbers::pi * random.uniform());
    Bounce const bounce = self.move_by(step_length * v);
    self.template set<VelocityX>(bounce.x ? -v.x : v.x);
    self.template set<VelocityY>(bounce.y ? -v.y : v.y);
  }

  constexpr void come_and_go(auto& self, auto& random) const {
    if (random.uniform() < turnover_rate * step_length && self.population() < most_agents) {
      Vector const v = speed * direction(2.0 * std::numbers::pi * random.uniform());
      Vector const p = self.position();
      self.give_birth(p.x, p.y, v.x, v.y, static_cast<std::uint32_t>(susceptible));
      self.count(2);
    }
    if (random.uniform() < turnover_rate * step_length) {
      self.die();
      self.count(3);
    }
  }
};

}  // namespace gridlock
