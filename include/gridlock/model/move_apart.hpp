#pragma once

/// \file
/// Moves of agents that have a size and do not go into each other.
///
/// ```cpp
/// struct Crowd {
///   static constexpr Schedule schedule = Schedule::sequential;
///   using Agents = Population<X, Y, Radius>;
///   double cutoff() const { return 0.02; }  // twice the largest radius
///   void turn(Turn<Crowd>& self) const {
///     auto const halt = move_apart(self, {0.001, 0.0}, 5);
///     if (halt.partner) halt.partner->kill();
///   }
/// };
/// ```

#include <cstdint>
#include <limits>
#include <optional>

#include "gridlock/core/disks.hpp"
#include "gridlock/model/turn.hpp"

namespace gridlock {

/// The obstacles that have halted an agent: walls along x and along y, or another agent.
template <class Model>
struct Halt {
  Bounce wall;
  std::optional<Neighbour<Model>> partner;  ///< seen from the point that was tried

  /// Returns whether anything has halted the agent.
  explicit operator bool() const { return wall.x || wall.y || partner; }
};

namespace detail {

/// Throws RunFailure for a part with which an agent could jump over another, and for radii that the cutoff is too small
/// for.
void require_short_part(std::uint64_t step, Id agent, Vector part, double radius);
void require_radius(std::uint64_t step, Id agent, double radius, double cutoff);

/// Returns the walls that a disk would come too near to at `trial`.
inline Bounce walls_at(Box const& box, Vector trial, Vector part, double radius) {
  auto const meets = [radius](double place, double side, double by) {
    return (place < radius && by < 0.0) || (place > side - radius && by > 0.0) || place < 0.0 || place > side;
  };
  return {.x = !box.is_periodic_x() && meets(trial.x, box.width(), part.x),
          .y = !box.is_periodic_y() && meets(trial.y, box.height(), part.y)};
}

/// Returns the agent that forbids a move from `here` to `trial`, if there is one.
template <class Model>
std::optional<Neighbour<Model>> partner_at(Turn<Model> const& self, Vector here, Vector trial) {
  double const radius = self.template get<Radius>();
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<Neighbour<Model>> partner;
  self.for_each_neighbour(trial, radius + 0.5 * self.cutoff(), [&](Neighbour<Model> const& other) {
    double const other_radius = other.template get<Radius>();
    require_radius(self.clock().step, other.id(), other_radius, self.cutoff());
    double const contact = radius + other_radius;
    double const distance = squared_length(other.separation());
    if (!(distance < contact * contact) || distance > nearest) return;
    if (distance == nearest && other.id() > partner->id()) return;
    if (distance >= squared_length(self.box().displacement(here, other.position()))) return;
    nearest = distance;
    partner.emplace(other);
  });
  return partner;
}

}  // namespace detail

/// Moves an agent by `part` up to `parts` times, as a disk of the radius in its column Radius that goes into no other:
/// the rule of the engine `stepped`, with the same bits.
///
/// The first part that would bring it nearer than its radius to a wall, or nearer than the sum of their radii to
/// another agent, halts it before this part; its partner is the nearest such agent, of two equally near ones that with
/// the lower Id. An agent that overlaps a wall or another already may move away from it. Columns ImageX and ImageY
/// count the periodic edges that it crosses. The cutoff of the model is at least twice the largest radius; an agent
/// with a larger one that never moves may be overlooked. For models that are sequential or tiled.
/// Errors: RunFailure for a part as long as the radius, with which the agent could jump over another, and for a radius
/// above half the cutoff. Cost: one search for each part.
/// Source: the rule of J.-X. Shen's paper, see docs/explanation/paper.md.
template <class Model>
Halt<Model> move_apart(Turn<Model>& self, Vector part,
                       std::uint64_t parts) requires(Model::schedule == Schedule::sequential ||
                                                     Model::schedule == Schedule::tiled) {
  Box const& box = self.box();
  double const radius = self.template get<Radius>();
  detail::require_radius(self.clock().step, self.id(), radius, self.cutoff());
  detail::require_short_part(self.clock().step, self.id(), part, radius);
  Vector here = self.position();
  int crossed_x = 0;
  int crossed_y = 0;
  Halt<Model> halt;
  for (std::uint64_t k = 0; k < parts; ++k) {
    Vector trial = here + part;
    halt.wall = detail::walls_at(box, trial, part, radius);
    if (halt) break;
    int trial_crossed_x = crossed_x;
    int trial_crossed_y = crossed_y;
    // Wrapping rounds, so it comes before the search: the point that is kept is the one that was looked at.
    trial = box.wrap(trial, trial_crossed_x, trial_crossed_y);
    if (auto const partner = detail::partner_at(self, here, trial)) {
      halt.partner.emplace(*partner);
      break;
    }
    here = trial;
    crossed_x = trial_crossed_x;
    crossed_y = trial_crossed_y;
  }
  if constexpr (World<Model>::Agents::template has<ImageX>) {
    self.template set<ImageX>(self.template get<ImageX>() + crossed_x);
    self.template set<ImageY>(self.template get<ImageY>() + crossed_y);
  }
  self.move_to(here);
  return halt;
}

}  // namespace gridlock
