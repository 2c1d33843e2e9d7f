#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/model/model.hpp"

namespace gridlock {

/// The rule for hard disks of J.-X. Shen's paper as a model like any other, on one page. The engines are faster.
///
/// In its turn a disk tries `substeps` steps of v dt/substeps. One that would cross a wall turns that component of v
/// back and ends the turn. One that would overlap a disk ends it too, and the two collide elastically along the line
/// between their present centres; of several the disk collides with the one nearest to the point it tried, ties to the
/// lower Id.
///
/// `Self` is the model that follows the rule: it has a name and says in which order disks take their turns.
template <class Self>
struct ColloidRule {
  using Agents = Disks;
  static constexpr bool keeps_counters = true;
  static constexpr std::array<std::string_view, 3> events{"pair_collisions", "wall_hits", "halted_moves"};

  DisksSettings disks{.count = 841, .packing_fraction = 0.5};
  VelocitySettings velocities;
  double step_length = 0.1;
  std::uint64_t substeps = 5;
  CollisionRule contact = CollisionRule::always;

  void describe(SettingVisitor& visitor) {
    static constexpr std::array<std::string_view, 2> contacts{"always", "approaching"};
    visitor.visit({.key = "step_length",
                   .unit = "σ / velocities.max",
                   .documentation = "Length of a time step, σ being the smallest diameter.",
                   .min = 0.0,
                   .min_is_allowed = false},
                  step_length);
    visitor.visit({.key = "substeps", .documentation = "Moves tried in a turn.", .min = 1, .max = 1e6}, substeps);
    visit_enum(
        visitor,
        {.key = "contact", .documentation = "Which pairs collide: every pair that meets, or only pairs that approach."},
        contacts, contact);
    visitor.enter("disks", "How many disks, how large, and where they start.");
    gridlock::describe(disks, visitor);
    visitor.leave();
    visitor.enter("velocities", "How fast the disks are at the start.");
    gridlock::describe(velocities, visitor);
    visitor.leave();
  }

  /// Starts are made, not read, and without overlaps. Collisions soon give some disk twice the largest speed: a
  /// sub-step in which it covers a diameter could jump over a disk.
  void check(Box const& /*box*/) const {
    if (!disks.file.empty()) {
      throw Error({.what = "the model \"" + std::string(Self::name) + "\" starts from no file",
                   .hint = "hard disks do: model.kind = \"disks\"",
                   .key = "disks.file"});
    }
    if (disks.start == StartKind::uniform && count_of(disks) > 1) {
      throw Error({.what = "disks at uniform points overlap, and the model \"" + std::string(Self::name) +
                           "\" is one of hard disks",
                   .hint = "use disks.start = \"random\"",
                   .key = "disks.start"});
    }
    double const diameters = 2.0 * step_length / static_cast<double>(substeps);
    if (diameters < 1.0) return;
    throw Error(
        {.what = "a disk at twice velocities.max would cover a diameter in one sub-step and could jump over another",
         .hint = "use a smaller step_length or more substeps",
         .key = "step_length"});
  }

  [[nodiscard]] std::uint64_t agents_at_start() const { return count_of(disks); }
  [[nodiscard]] double attempts_at_start(Box const& box, std::uint64_t seed) const {
    return expected_attempts(box, disks, seed);
  }

  /// The largest contact distance.
  [[nodiscard]] double cutoff(AgentSums<Self> const& all) const { return 2.0 * radii_of(all).largest; }
  [[nodiscard]] double time_step(AgentSums<Self> const& all) const {
    double const diameter = 2.0 * radii_of(all).smallest;
    return step_length * diameter / (velocities.max > 0.0 ? velocities.max : 1.0);
  }
  void start(World<Self>& world) const {
    State state = make_start(world.box, disks, world.seed);
    draw_velocities(state, velocities);
    world.agents = std::move(state.agents);
  }

  void turn(Turn<Self>& self) const {
    ++self.counters().moves;
    Vector const displacement = (self.time_step() / static_cast<double>(substeps)) * velocity(self);
    Halt<Self> const halt = move_apart(self, displacement, substeps);
    if (!halt) return;
    self.count(2);
    ++self.counters().halted_moves;
    if (halt.partner) {
      collide(self, *halt.partner);
    } else {
      turn_back(self, halt.wall);
    }
  }

  void observe(AgentSums<Self> const& all, Observations& seen) const {
    seen.add("coverage", area_of(all) / all.box().area(), "Σ π R² / area.");
  }

 protected:
  static double radius_of(auto const& disk) { return disk.template get<Radius>(); }
  static RadiusRange radii_of(AgentSums<Self> const& all) {
    if (all.size() == 0) return {};
    return {.smallest = all.min([](auto const& disk) { return radius_of(disk); }),
            .largest = all.max([](auto const& disk) { return radius_of(disk); })};
  }
  /// Σ π R².
  static double area_of(AgentSums<Self> const& all) {
    return std::numbers::pi * all.sum([](auto const& disk) { return radius_of(disk) * radius_of(disk); });
  }

  static Vector velocity(auto const& disk) { return {disk.template get<VelocityX>(), disk.template get<VelocityY>()}; }
  static void set_velocity(auto& disk, Vector v) {
    disk.template set<VelocityX>(v.x);
    disk.template set<VelocityY>(v.y);
  }
  /// Exact: half of twice the largest radius.
  static double largest_contact(Turn<Self> const& self) { return self.template get<Radius>() + 0.5 * self.cutoff(); }

  static void turn_back(Turn<Self>& self, Bounce wall) {
    Vector v = velocity(self);
    auto const reflect = [&](Counters::Wall left, Counters::Wall right, double& component) {
      Counters::Wall const side = component < 0.0 ? left : right;
      ++self.counters().wall_hits[side];
      self.counters().wall_impulse[side] += 2.0 * self.template get<Mass>() * std::abs(component);
      component = -component;
    };
    if (wall.x) reflect(Counters::left, Counters::right, v.x);
    if (wall.y) reflect(Counters::bottom, Counters::top, v.y);
    set_velocity(self, v);
    self.count(1);
  }

  /// Δv_i = −(2 m_j / (m_i + m_j)) (w·b / b²) b and the opposite impulse for j, with w = v_i − v_j and b = r_j − r_i.
  void collide(Turn<Self>& self, Neighbour<Self> const& other) const {
    Vector const b = self.box().displacement(self.position(), other.position());
    double const approach = dot(velocity(self) - velocity(other), b);
    if (contact == CollisionRule::approaching && !(approach > 0.0)) return;
    double const m_i = self.template get<Mass>();
    double const m_j = other.template get<Mass>();
    double const along = 2.0 * approach / ((m_i + m_j) * squared_length(b));
    Vector const change = (-m_j * along) * b;
    set_velocity(self, velocity(self) + change);
    set_velocity(other, velocity(other) + (m_i * along) * b);
    self.count(0);
    ++self.counters().pair_collisions;
    self.counters().pair_virial -= m_i * dot(b, change);
  }
};

/// In the order of the Ids: the bits of the engine `stepped`.
struct Colloid : ColloidRule<Colloid> {
  static constexpr Schedule schedule = Schedule::sequential;
  static constexpr std::string_view name = "colloid";
  static constexpr std::string_view documentation =
      "The paper's hard disks as a model: the bits of the engine stepped.";
};

}  // namespace gridlock
