#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

#include "gridlock/model/model.hpp"

namespace gridlock {

struct HeadingX {
  using type = double;
  static constexpr char const* name = "heading_x";
};
struct HeadingY {
  using type = double;
  static constexpr char const* name = "heading_y";
};

enum class FlockingRule { vicsek, boids };

/// Agents of constant speed that turn to the direction of their neighbours, all at the same time.
///
/// Vicsek: x' = x + v θ, θ' = direction of Σ θ_j over all agents within the radius and the agent, turned by an angle
/// uniform in [−η/2, η/2] (Vicsek et al. 1995, doi:10.1103/PhysRevLett.75.1226). Boids: v' = (v + c·mean(r_j) −
/// s·mean(r_j of agents nearer than the separation) + a·mean(v_j)) / 2, made a unit vector, x' = x + speed·v': the rule
/// of the public comparison of agent frameworks, where agents act one by one.
struct Flocking {
  static constexpr std::string_view name = "flocking";
  static constexpr std::string_view documentation = "Agents that turn to where their neighbours go.";
  static constexpr Schedule schedule = Schedule::synchronous;
  static constexpr bool runs_on_device = true;
  using Agents = Population<X, Y, HeadingX, HeadingY>;

  std::uint64_t count = 400;
  FlockingRule rule = FlockingRule::vicsek;
  double radius = 1.0;
  double speed = 0.03;
  double noise = 1.0;
  double separation = 1.0;
  double cohesion_factor = 0.03;
  double separation_factor = 0.015;
  double alignment_factor = 0.05;

  void describe(SettingVisitor& visitor) {
    static constexpr std::array<std::string_view, 2> rules{"vicsek", "boids"};
    visitor.visit({.key = "count", .documentation = "Agents.", .min = 1, .max = 2e9}, count);
    visit_enum(visitor, {.key = "rule", .documentation = "Alignment with noise, or alignment, cohesion, separation."},
               rules, rule);
    visitor.visit({.key = "radius",
                   .unit = "length",
                   .documentation = "How far an agent sees.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  radius);
    visitor.visit({.key = "speed",
                   .unit = "length / step",
                   .documentation = "Of every agent; a step is shorter than the box.",
                   .min = 0.0},
                  speed);
    visitor.visit({.key = "noise",
                   .unit = "radian",
                   .documentation = "η of vicsek: headings turn by a random angle in [−η/2, η/2].",
                   .min = 0.0,
                   .max = 2.0 * std::numbers::pi},
                  noise);
    visitor.visit(
        {.key = "separation", .unit = "length", .documentation = "Boids nearer than this keep apart.", .min = 0.0},
        separation);
    auto const factor = [&](std::string_view key, std::string_view text, double& value) {
      visitor.visit({.key = key, .documentation = text, .min = -1e6, .max = 1e6}, value);
    };
    factor("cohesion_factor", "How much boids come together.", cohesion_factor);
    factor("separation_factor", "How much boids keep apart.", separation_factor);
    factor("alignment_factor", "How strongly boids align their direction with that of their neighbours.",
           alignment_factor);
  }
  void check(Box const& box) const { require_displacement(box, speed, "speed"); }
  [[nodiscard]] std::uint64_t agents_at_start() const { return count; }

  [[nodiscard]] double cutoff() const { return radius; }
  [[nodiscard]] double time_step() const { return 1.0; }

  [[nodiscard]] Agents::Values first_agent(World<Flocking> const& world, std::uint64_t number) const {
    RandomStream random = world.start_random(number);
    Vector const p = world.anywhere(random);
    Vector const heading = direction(2.0 * std::numbers::pi * random.uniform());
    return {p.x, p.y, heading.x, heading.y};
  }

  constexpr void turn(auto& self) const {
    if (rule == FlockingRule::vicsek) {
      align(self);
    } else {
      flock(self);
    }
  }

  /// Returns the order v_a = |Σ θ| / N: 1 where all agents move in one direction, about 1/√N for random directions.
  static double order(AgentSums<Flocking> const& agents) {
    Vector const sum{agents.sum([](auto const& agent) { return agent.template get<HeadingX>(); }),
                     agents.sum([](auto const& agent) { return agent.template get<HeadingY>(); })};
    return std::sqrt(squared_length(sum)) / static_cast<double>(agents.size());
  }
  void observe(AgentSums<Flocking> const& agents, Observations& seen) const {
    seen.add("order", order(agents), "|Σ heading| / N: 1 where all move in one direction.");
  }

 private:
  static constexpr Vector heading_of(auto const& agent) {
    return {agent.template get<HeadingX>(), agent.template get<HeadingY>()};
  }
  static constexpr void turn_to(auto& self, Vector heading) {
    self.template set<HeadingX>(heading.x);
    self.template set<HeadingY>(heading.y);
  }

  constexpr void align(auto& self) const {
    // Drawn first, so that the processor computes it while it waits for the neighbours' memory.
    auto random = self.random();
    Vector const turned = direction(noise * (random.uniform() - 0.5));
    Vector const heading = heading_of(self);
    Vector sum = heading;
    self.for_each_neighbour(radius, [&](auto const& other) { sum = sum + heading_of(other); });
    double const length = std::sqrt(squared_length(sum));
    Vector const mean = length > 0.0 ? (1.0 / length) * sum : heading;
    turn_to(self, rotated(mean, turned));
    self.move_by(speed * heading);
  }

  constexpr void flock(auto& self) const {
    double neighbours = 0.0;
    Vector together;
    Vector apart;
    Vector along;
    self.for_each_neighbour(radius, [&](auto const& other) {
      Vector const offset = other.separation();
      neighbours += 1.0;
      together = together + offset;
      if (squared_length(offset) < separation * separation) apart = apart - offset;
      along = along + heading_of(other);
    });
    double const share = 1.0 / std::max(neighbours, 1.0);
    Vector const wish = heading_of(self) + (share * cohesion_factor) * together + (share * separation_factor) * apart +
                        (share * alignment_factor) * along;
    double const length = std::sqrt(squared_length(wish));
    Vector const heading = length > 0.0 ? (1.0 / length) * wish : heading_of(self);
    turn_to(self, heading);
    self.move_by(speed * heading);
  }
};

}  // namespace gridlock
