#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/model/model.hpp"

namespace gridlock {

struct Species {
  using type = std::uint32_t;
  static constexpr char const* name = "species";
  static constexpr std::array<std::string_view, 2> value_names{"molecule A", "molecule B"};
};

enum class Reaction { none, a_with_b, a_with_a };

/// Disks of radius R that adsorb on a surface where they fit, desorb, diffuse as hard disks, and react on contact.
///
/// The method is kinetic Monte Carlo by rejection, exact in time: events come at the total rate
///     (k_A + k_B)·area + N·(k_d + ν)
/// after exponential waiting times. An adsorption is tried at a point drawn anywhere and happens if no centre is nearer
/// than 2R; without other events it is random sequential adsorption (Wang 1994, doi:10.1103/PhysRevE.50.3635). A
/// desorption takes any disk. A hop tries a point uniform in a disk of radius `hop` around the old one, or anywhere if
/// `hop` is 0, and happens if the disk fits there. A hop onto a partner makes both leave with the given probability. In
/// equilibrium the coverage θ = NπR²/A follows θ/Φ(θ) = k_a πR²/k_d with the available surface Φ. Between walls centres
/// lie in the whole box. Steps only divide time: shorter steps make more grids and draw other random numbers.
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
      visitor.visit({.key = key, .unit = unit, .documentation = text, .min = 0.0}, value);
    };
    visitor.visit({.key = "radius",
                   .unit = "length",
                   .documentation = "R of every molecule.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  radius);
    number("adsorption_rate", "1 / (area · time)", "k_A: tries of the species A.", adsorption_rate);
    number("adsorption_rate_b", "1 / (area · time)", "k_B: tries of the species B.", adsorption_rate_b);
    number("desorption_rate", "1 / time", "k_d, of each molecule.", desorption_rate);
    number("hop_rate", "1 / time", "ν: tries of each molecule to hop.", hop_rate);
    number("hop", "length",
           "The farthest a molecule hops, less than the sides of the box; 0: anywhere, which mixes well.", hop);
    visit_enum(visitor, {.key = "reaction", .documentation = "Who leaves together with whom on contact."}, reactions,
               reaction);
    visitor.visit({.key = "reaction_probability",
                   .documentation = "That a hop onto a partner makes both leave.",
                   .min = 0.0,
                   .max = 1.0},
                  reaction_probability);
    visitor.visit({.key = "count", .documentation = "Molecules A at the start, at random places.", .max = 2e9}, count);
    visitor.visit({.key = "count_b", .documentation = "Molecules B at the start, at random places.", .max = 2e9},
                  count_b);
    visitor.visit({.key = "step_length",
                   .unit = "time",
                   .documentation = "Physical time of one step, in which any number of events happen, up to 10⁸ on "
                                    "average.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  step_length);
  }

  /// Throws Error for more molecules than the closest packing holds, and for steps that would take minutes.
  void check(Box const& box) const {
    if (hop_rate > 0.0) require_displacement(box, hop, "hop");
    double const wanted = static_cast<double>(count) + static_cast<double>(count_b);
    if (wanted > max_molecules(box)) {
      throw too_many_molecules("the closest packing holds at most " + in_words(max_molecules(box)), box);
    }
    bool const grows = adsorption_rate + adsorption_rate_b > 0.0;
    double const molecules = grows ? max_molecules(box) : wanted;
    double const rate = (adsorption_rate + adsorption_rate_b) * box.area() + molecules * (desorption_rate + hop_rate);
    if (rate * step_length <= max_events) return;
    throw Error({.what = "a step of " + in_words(step_length) + " of time would take up to " +
                         in_words(rate * step_length) + " events, more than " + in_words(max_events),
                 .hint = "use step_length = " + in_words(max_events / rate) + " or less, or smaller rates",
                 .key = "step_length"});
  }
  [[nodiscard]] std::uint64_t agents_at_start() const { return count + count_b; }
  [[nodiscard]] double attempts_at_start(Box const& box, std::uint64_t seed) const {
    return expected_attempts(box, {.count = count + count_b, .radius = radius, .start = StartKind::random}, seed);
  }

  [[nodiscard]] double cutoff() const { return 2.0 * radius; }
  [[nodiscard]] double time_step() const { return step_length; }

  /// Errors: Error where not all molecules can be placed at random.
  void start(World<Catalyst>& world) const {
    std::uint64_t const wanted = count + count_b;
    // In a small box a random start can exceed the saturation of the infinite plane by chance.
    double const saturation = random_molecules(world.box);
    if (wanted >= 1000 && static_cast<double>(wanted) > 1.05 * saturation) {
      throw too_many_molecules("at random places about " + in_words(saturation) + " find room", world.box);
    }
    PackedGrid grid(layout_for_cutoff(world.box, cutoff(), 2 * wanted + 16));
    MutableWorld<Catalyst> open(world, grid, cutoff(), false);
    RandomStream random = world.start_random(0);
    // Near saturation one try in some thousands succeeds.
    std::uint64_t tries = 20'000'000 + 1000 * wanted;
    std::uint64_t placed = 0;
    for (; placed < wanted && tries > 0; --tries) {
      Vector const p = world.anywhere(random);
      if (open.nearest(p, cutoff())) continue;
      open.add(p.x, p.y, radius, placed < count ? 0U : 1U);
      ++placed;
    }
    if (placed < wanted) {
      throw too_many_molecules("random places were found for " + std::to_string(placed), world.box);
    }
  }

  void step(MutableWorld<Catalyst>& surface) const {
    RandomStream random = surface.random();
    double const area = surface.box().area();
    double const adsorption = (adsorption_rate + adsorption_rate_b) * area;
    for (double time = 0.0;;) {
      double const desorption = desorption_rate * static_cast<double>(surface.size());
      double const total = adsorption + desorption + hop_rate * static_cast<double>(surface.size());
      if (!(total > 0.0)) return;
      time += random.exponential() / total;
      // The rest of the last waiting time is dropped: an exponential waiting time has no memory.
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

  /// Returns the coverage θ = N π R² / A.
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
  /// Largest number of events in a step. An event takes about 0.2 µs, and a run can stop only between steps.
  static constexpr double max_events = 1e8;

  /// Returns the largest number of points at least a diameter apart: the closest packing, and at walls the inequality
  /// of Oler 1961, N ≤ (2/√3) A/d² + P/(2d) + 1.
  [[nodiscard]] double max_molecules(Box const& box) const {
    double const d = 2.0 * radius;
    double const closest = 2.0 / std::numbers::sqrt3 * (box.width() / d) * (box.height() / d);
    double const at_walls = box.is_periodic() ? 0.0 : (box.width() + box.height()) / d + 1.0;
    return std::floor((closest + at_walls) * (1.0 + 1e-12));
  }
  /// Returns the number of molecules that random sequential adsorption places: the fraction 0.547069 of the area (Wang
  /// 1994), with molecules on the edge included.
  [[nodiscard]] double random_molecules(Box const& box) const {
    double const margin = box.is_periodic() ? 0.0 : 2.0 * radius;
    return std::floor(0.547069 / std::numbers::pi * ((box.width() + margin) / radius) *
                      ((box.height() + margin) / radius));
  }
  [[nodiscard]] Error too_many_molecules(std::string const& what_fits, Box const& box) const {
    return Error({.what = std::to_string(count + count_b) + " molecules of radius " + in_words(radius) +
                          " find no room at the start: " + what_fits,
                  .hint = "use " + in_words(std::floor(0.9 * random_molecules(box))) + " or fewer, or a smaller radius",
                  .key = count > 0 ? "count" : "count_b"});
  }

  static Vector anywhere(MutableWorld<Catalyst> const& surface, RandomStream& random) {
    double const x = random.uniform() * surface.box().width();
    return {x, random.uniform() * surface.box().height()};
  }
  static Id any(MutableWorld<Catalyst> const& surface, RandomStream& random) {
    return surface.agent_in_row(random.below(surface.size()));
  }

  void adsorb(MutableWorld<Catalyst>& surface, RandomStream& random, std::uint32_t species) const {
    surface.count(0);
    Vector const p = anywhere(surface, random);
    if (surface.nearest(p, cutoff())) return;
    surface.add(p.x, p.y, radius, species);
    surface.count(1);
  }

  [[nodiscard]] bool react(std::uint32_t one, std::uint32_t other) const {
    if (reaction == Reaction::a_with_b) return one != other;
    return reaction == Reaction::a_with_a && one == 0 && other == 0;
  }

  void hop_from(MutableWorld<Catalyst>& surface, RandomStream& random, Id id) const {
    surface.count(3);
    Vector p;
    if (hop > 0.0) {
      Motion const to = motion(surface.box(), surface.position(id), hop * random.in_unit_disk());
      // A molecule that would leave the surface stays: a reflected hop would be drawn more often than its reverse.
      if (to.bounce.x || to.bounce.y) return;
      p = to.end;
    } else {
      p = anywhere(surface, random);
    }
    std::optional<Id> const met = surface.nearest(p, cutoff(), id);
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
