#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

#include "gridlock/model/model.hpp"

namespace gridlock {

struct Species {
  using type = std::uint32_t;
  static constexpr char const* name = "species";
};

enum class Reaction { none, a_with_b, a_with_a };

/// Disks of radius R that adsorb on a surface where they fit, desorb, diffuse as hard disks, and react on contact.
///
/// Kinetic Monte Carlo by rejection, exact in time: events come at the total rate
///     (k_A + k_B)·area + N·(k_d + ν)
/// after exponential waiting times. An adsorption is tried at a point drawn anywhere and happens if no centre is nearer
/// than 2R (random sequential adsorption where nothing else is on, Wang 1994, doi:10.1103/PhysRevE.50.3635); a desorption
/// takes any disk; a hop tries a point uniform in a disk of radius `hop` around the old one, or anywhere if it is 0, and
/// happens if the disk fits there. A hop onto a partner makes both leave with the given probability.
/// In equilibrium the coverage θ = NπR²/A follows θ/Φ(θ) = k_a πR²/k_d with the available surface Φ. Between walls centres
/// lie in the whole box.
/// A step is a stretch of time: shorter ones cost a new grid each, and change only which random numbers are drawn.
struct Catalyst {
  static constexpr std::string_view name = "catalyst";
  static constexpr std::string_view documentation = "Molecules that adsorb, desorb, diffuse and react on a surface.";
  static constexpr Schedule schedule = Schedule::events;
  static constexpr std::array<std::string_view, 6> events{"adsorption_tries", "adsorptions", "desorptions",
                                                          "hop_tries",        "hops",        "reactions"};
  using Agents = Population<X, Y, Radius, Species>;

  double radius = 0.01;
  double adsorption_rate = 1.0;
  double adsorption_rate_b = 0.0;
  double desorption_rate = 0.0;
  double hop_rate = 0.0;
  double hop = 0.01;
  Reaction reaction = Reaction::none;
  double reaction_probability = 1.0;
  std::uint64_t count = 0;
  std::uint64_t count_b = 0;
  double step_length = 1.0;

  void describe(SettingVisitor& visitor) {
    static constexpr std::array<std::string_view, 3> reactions{"none", "a_with_b", "a_with_a"};
    auto const number = [&](std::string_view key, std::string_view unit, std::string_view text, double& value) {
      visitor.visit({.key = key, .unit = unit, .documentation = text, .least = 0.0}, value);
    };
    visitor.visit({.key = "radius",
                   .unit = "length",
                   .documentation = "R of every molecule.",
                   .least = 0.0,
                   .least_is_allowed = false},
                  radius);
    number("adsorption_rate", "1 / (area · time)", "k_A: tries of the species A.", adsorption_rate);
    number("adsorption_rate_b", "1 / (area · time)", "k_B: tries of the species B.", adsorption_rate_b);
    number("desorption_rate", "1 / time", "k_d, of each molecule.", desorption_rate);
    number("hop_rate", "1 / time", "ν: tries of each molecule to hop.", hop_rate);
    number("hop", "length", "The farthest a molecule hops; 0: anywhere, which mixes well.", hop);
    visit_enum(visitor, {.key = "reaction", .documentation = "Who leaves together with whom on contact."}, reactions,
               reaction);
    visitor.visit({.key = "reaction_probability",
                   .documentation = "That a hop onto a partner makes both leave.",
                   .least = 0.0,
                   .most = 1.0},
                  reaction_probability);
    visitor.visit({.key = "count", .documentation = "Molecules A at the start, where they fit."}, count);
    visitor.visit({.key = "count_b", .documentation = "Molecules B at the start, where they fit."}, count_b);
    visitor.visit({.key = "step_length",
                   .unit = "time",
                   .documentation = "Physical time of one step, in which any number of events happen.",
                   .least = 0.0,
                   .least_is_allowed = false},
                  step_length);
  }

  [[nodiscard]] double reach() const { return 2.0 * radius; }
  [[nodiscard]] double time_step() const { return step_length; }

  void start(World<Catalyst>& world) const {
    PackedGrid grid(layout_for_reach(world.box, reach(), 2 * (count + count_b) + 16));
    OpenWorld<Catalyst> open(world, grid, false);
    RandomStream random = world.start_random(0);
    // One try in 10,000 fits at a coverage of 0.54: more than that has no place.
    std::uint64_t tries = 10'000 * (count + count_b);
    for (std::uint64_t n = 0; n < count + count_b && tries > 0; --tries) {
      Vector const p = world.anywhere(random);
      if (open.nearest(p, reach())) continue;
      open.add(p.x, p.y, radius, n < count ? 0U : 1U);
      ++n;
    }
  }

  void step(OpenWorld<Catalyst>& surface) const {
    RandomStream random = surface.random();
    double const area = surface.box().area();
    double const adsorption = (adsorption_rate + adsorption_rate_b) * area;
    for (double time = 0.0;;) {
      double const desorption = desorption_rate * static_cast<double>(surface.size());
      double const total = adsorption + desorption + hop_rate * static_cast<double>(surface.size());
      if (!(total > 0.0)) return;
      time += random.exponential() / total;
      // What is left of the last waiting time may be forgotten: an exponential one has no memory.
      if (time > step_length) return;
      double const which = random.uniform() * total;
      if (which < adsorption) {
        adsorb(surface, random, which < adsorption_rate * area ? 0U : 1U);
      } else if (which < adsorption + desorption) {
        surface.remove(any(surface, random));
        surface.count(2);
      } else if (surface.size() > 0) {
        hop_from(surface, random, any(surface, random));
      }
    }
  }

  /// θ = N π R² / A.
  static double coverage(World<Catalyst> const& world) {
    double area = 0.0;
    for (double const r : world.agents.column<Radius>()) area += std::numbers::pi * r * r;
    return area / world.box.area();
  }
  void observe(World<Catalyst> const& world, Observations& seen) const {
    seen.add("coverage", coverage(world), "θ = N π R² / area.");
    seen.add_counts<Species>(world.agents, {"molecules_a", "molecules_b"});
  }

 private:
  static Vector anywhere(OpenWorld<Catalyst> const& surface, RandomStream& random) {
    double const x = random.uniform() * surface.box().width();
    return {x, random.uniform() * surface.box().height()};
  }
  static Id any(OpenWorld<Catalyst> const& surface, RandomStream& random) {
    return surface.agent_in_row(random.below(surface.size()));
  }

  void adsorb(OpenWorld<Catalyst>& surface, RandomStream& random, std::uint32_t species) const {
    surface.count(0);
    Vector const p = anywhere(surface, random);
    if (surface.nearest(p, reach())) return;
    surface.add(p.x, p.y, radius, species);
    surface.count(1);
  }

  [[nodiscard]] bool react(std::uint32_t one, std::uint32_t other) const {
    if (reaction == Reaction::a_with_b) return one != other;
    return reaction == Reaction::a_with_a && one == 0 && other == 0;
  }

  void hop_from(OpenWorld<Catalyst>& surface, RandomStream& random, Id id) const {
    surface.count(3);
    Vector p;
    if (hop > 0.0) {
      Motion const to = motion(surface.box(), surface.position(id), hop * random.in_unit_disk());
      // A molecule that would leave the surface stays: mirrored hops would be drawn more often than they are taken back.
      if (to.bounce.x || to.bounce.y) return;
      p = to.end;
    } else {
      p = anywhere(surface, random);
    }
    std::optional<Id> const met = surface.nearest(p, reach(), id);
    if (!met) {
      surface.move_to(id, p);
      surface.count(4);
    } else if (react(surface.get<Species>(id), surface.get<Species>(*met)) && random.uniform() < reaction_probability) {
      surface.remove(id);
      surface.remove(*met);
      surface.count(5);
    }
  }
};

}  // namespace gridlock
