#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "engine/obstacles.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// A copy of one disk for the loop over moves; it fills one cache line. A fixed disk, of infinite mass, never moves: it
/// takes its turns at rest, and others halt at it.
struct alignas(64) DiskInTurn {
  Vector position;
  Vector velocity;
  double radius;
  double mass;
  std::int32_t image_x;
  std::int32_t image_y;
  std::uint32_t id_index;      ///< index in the order of the Ids
  std::uint32_t row_in_state;  ///< row of the disk in the state

  [[nodiscard]] constexpr bool is_fixed() const { return gridlock::is_fixed(mass); }
};
static_assert(sizeof(DiskInTurn) == 64);

/// The numbers that the headings of self-propelled disks turn by in one step; headings.hpp says how.
struct HeadingStep {
  std::uint32_t key;  ///< key and counter of the random numbers
  std::uint32_t word;
  float width;            ///< standard deviation of the turn, in radians
  double inverse_square;  ///< 1 / speed²
};

/// The disks and the constants that a turn needs, borrowed for one advance().
struct TurnView {
  Box const& box;
  std::span<DiskInTurn> disks;
  double substep;          ///< duration of a sub-step
  std::uint64_t substeps;  ///< number of sub-steps in a turn
  CollisionRule contact;
  /// The step of self-propelled disks, whose headings turn before their turn and which keep their velocities where they
  /// halt; nullptr for others.
  HeadingStep const* heading = nullptr;
  ObstaclesView walls = {};  ///< walls inside the box

  [[nodiscard]] constexpr bool is_propelled() const { return heading != nullptr; }
};

/// The nearest disk that overlaps a trial point, ties to the lower Id. This choice does not depend on the order of
/// visits, so the trajectory does not depend on the grid.
class Partner {
 public:
  constexpr Partner(TurnView const& view, std::size_t turning, Vector trial)
      : view_(view), turning_(turning), radius_(view.disks[turning].radius), trial_(trial) {}

  /// Looks at one candidate; the moving disk itself is ignored.
  constexpr void consider(std::size_t candidate) {
    if (candidate == turning_) return;
    ++checks_;
    DiskInTurn const& other = view_.disks[candidate];
    double const contact = radius_ + other.radius;
    double const distance = squared_length(view_.box.displacement_inside(trial_, other.position));
    if (!(distance < contact * contact)) return;
    if (distance < nearest_ || (distance == nearest_ && other.id_index < view_.disks[partner_].id_index)) {
      nearest_ = distance;
      partner_ = candidate;
    }
  }

  [[nodiscard]] constexpr bool exists() const { return nearest_ < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] constexpr std::size_t index() const { return partner_; }
  [[nodiscard]] constexpr std::uint64_t checks() const { return checks_; }

 private:
  TurnView const& view_;
  std::size_t turning_;
  double radius_;
  Vector trial_;
  double nearest_ = std::numeric_limits<double>::infinity();
  std::size_t partner_ = 0;
  std::uint64_t checks_ = 0;
};

/// Reverses the velocity component that would carry a disk through a wall at `trial`, except that of a self-propelled
/// disk. Returns whether it hits a wall.
constexpr bool hits_wall(TurnView const& view, DiskInTurn& disk, Vector trial, Counters& counters) {
  Box const& box = view.box;
  if (box.is_periodic()) return false;
  double const r = disk.radius;
  bool is_hit = false;
  auto const reflect = [&](Counters::Wall wall, double& component) {
    ++counters.wall_hits[wall];
    is_hit = true;
    if (view.is_propelled()) return;
    counters.wall_impulse[wall] += 2.0 * disk.mass * std::abs(component);
    component = -component;
  };
  if (!box.is_periodic_x()) {
    if (trial.x < r) reflect(Counters::left, disk.velocity.x);
    if (trial.x > box.width() - r) reflect(Counters::right, disk.velocity.x);
  }
  if (!box.is_periodic_y()) {
    if (trial.y < r) reflect(Counters::bottom, disk.velocity.y);
    if (trial.y > box.height() - r) reflect(Counters::top, disk.velocity.y);
  }
  return is_hit;
}

/// Reverses the part of a disk's velocity along b. Returns the change of the velocity.
constexpr Vector reflect_along(Vector b, DiskInTurn& disk) {
  Vector const change = (-2.0 * dot(disk.velocity, b) / squared_length(b)) * b;
  disk.velocity = disk.velocity + change;
  return change;
}

/// Reflects a disk from the nearest wall inside the box that it overlaps at `trial`, ties to the first one, along the
/// line to that wall at the start of the sub-step; a self-propelled disk keeps its velocity. Returns whether it hits a
/// wall. No sub-step is as long as a diameter, so that none goes through a wall.
[[gnu::cold]] constexpr bool hits_inner_wall(TurnView const& view, DiskInTurn& disk, Vector trial, Vector displacement,
                                             Counters& counters) {
  if (disk.is_fixed()) return false;
  double const contact = disk.radius * (1.0 - rounding_at_walls);
  double nearest = contact * contact;
  Obstacle const* wall = nullptr;
  view.walls.for_each_near(trial, trial, [&](std::uint32_t k) {
    Obstacle const& other = view.walls[k];
    double const squared = squared_length(other.nearest_to(trial) - trial);
    if (!(squared < nearest || (squared == nearest && &other < wall))) return;
    nearest = squared;
    wall = &other;
  });
  if (wall == nullptr) return false;
  ++counters.inner_wall_hits;
  if (view.is_propelled()) return true;
  Vector const from = trial - displacement;  // on the side of the periodic edges on which `trial` is
  Vector const change = reflect_along(wall->nearest_to(from) - from, disk);
  counters.inner_wall_impulse += disk.mass * std::sqrt(squared_length(change));
  return true;
}

/// Reflects a disk from a fixed one as from a disk of infinite mass; see collide().
[[gnu::cold]] constexpr void reflect_from_fixed(Box const& box, DiskInTurn& self, DiskInTurn const& fixed,
                                                Counters& counters) {
  Vector const b = box.displacement_inside(self.position, fixed.position);
  Vector const change = reflect_along(b, self);
  ++counters.pair_collisions;
  counters.pair_virial -= self.mass * dot(b, change);
}

/// Applies the elastic rule along b = r_j − r_i at the present positions:
///     Δv_i = −(2 m_j / (m_i + m_j)) (w·b / b²) b,   Δv_j = +(2 m_i / (m_i + m_j)) (w·b / b²) b,   w = v_i − v_j,
/// It reverses the normal part of the relative velocity in the centre-of-mass frame and keeps momentum and energy.
constexpr void collide(TurnView const& view, std::size_t i, std::size_t j, Counters& counters) {
  if (view.is_propelled()) {
    ++counters.pair_collisions;
    return;
  }
  DiskInTurn& self = view.disks[i];
  DiskInTurn& other = view.disks[j];
  Vector const b = view.box.displacement_inside(self.position, other.position);
  Vector const w = self.velocity - other.velocity;
  double const approach = dot(w, b);
  if (view.contact == CollisionRule::approaching && !(approach > 0.0)) return;
  double const total_mass = self.mass + other.mass;
  if (other.is_fixed()) [[unlikely]]
    return reflect_from_fixed(view.box, self, other, counters);
  double const along = 2.0 * approach / (total_mass * squared_length(b));
  Vector const change_self = (-other.mass * along) * b;
  Vector const change_other = (self.mass * along) * b;
  self.velocity = self.velocity + change_self;
  other.velocity = other.velocity + change_other;
  ++counters.pair_collisions;
  counters.pair_virial -= self.mass * dot(b, change_self);
}

/// Whether a disk may get to an edge of the box, or to a wall inside it, in its turn. If it cannot, walls and wrapping
/// are left out.
enum class EdgeOfTurn { may_be_met, is_far };

/// Takes one disk's turn in one time step by the rule of the paper: up to `substeps` trial moves. The first that would
/// cross a wall or overlap a disk halts the disk for this step; it bounces off, or keeps its velocity if
/// self-propelled. The caller keeps the grid up to date.
///
/// search(partner) must call partner.consider(j) for every disk j that could overlap the trial point; visiting more
/// disks, or any order, gives the same bits.
template <EdgeOfTurn edge = EdgeOfTurn::may_be_met, class Search>
constexpr void take_turn(TurnView const& view, std::size_t i, Counters& counters, Search search) {
  ++counters.moves;
  // The position stays in registers until the turn is over, which saves an access to memory in every sub-step.
  DiskInTurn& disk = view.disks[i];
  Vector here = disk.position;
  Vector const displacement = view.substep * disk.velocity;
  int crossed_x = 0;
  int crossed_y = 0;
  auto const end_after = [&](std::uint64_t substeps) {
    disk.position = here;
    if (view.is_propelled()) {
      counters.swum += static_cast<double>(substeps);
      counters.swum_if_free += static_cast<double>(view.substeps);
    }
    if constexpr (edge == EdgeOfTurn::may_be_met) {
      disk.image_x += crossed_x;
      disk.image_y += crossed_y;
    }
  };
  std::uint64_t m = 0;
  for (; m < view.substeps; ++m) {
    Vector trial = here + displacement;
    int trial_crossed_x = crossed_x;
    int trial_crossed_y = crossed_y;
    if constexpr (edge == EdgeOfTurn::may_be_met) {
      if (hits_wall(view, disk, trial, counters)) {
        ++counters.halted_moves;
        break;
      }
      // Wrapping rounds, so it comes before the overlap check: the position that is kept must be the one checked.
      trial = view.box.wrap(trial, trial_crossed_x, trial_crossed_y);
      if (!view.walls.empty() && hits_inner_wall(view, disk, trial, displacement, counters)) {
        ++counters.halted_moves;
        break;
      }
    }
    Partner partner(view, i, trial);
    search(partner);
    counters.distance_checks += partner.checks();
    if (partner.exists()) {
      end_after(m);
      collide(view, i, partner.index(), counters);
      ++counters.halted_moves;
      return;
    }
    here = trial;
    crossed_x = trial_crossed_x;
    crossed_y = trial_crossed_y;
  }
  end_after(m);
}

}  // namespace gridlock
