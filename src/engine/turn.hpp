#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "gridlock/core/state.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock {

/// The columns of the disks and the constants one turn needs; borrowed for one advance().
struct TurnView {
  Box const& box;
  std::span<Id const> id;
  std::span<double> x, y, velocity_x, velocity_y;
  std::span<double const> radius, mass;
  std::span<std::int32_t> image_x, image_y;
  double substep;          ///< physical length of one sub-step
  std::uint64_t substeps;  ///< sub-steps in a turn
  Contact contact;

  [[nodiscard]] Vector position(std::size_t i) const { return {x[i], y[i]}; }
  [[nodiscard]] Vector velocity(std::size_t i) const { return {velocity_x[i], velocity_y[i]}; }
};

inline TurnView view_for_turns(State& state, EngineSettings const& settings, double duration) {
  Disks& disks = state.disks;
  return {.box = state.box,
          .id = disks.ids(),
          .x = disks.column<X>(),
          .y = disks.column<Y>(),
          .velocity_x = disks.column<VelocityX>(),
          .velocity_y = disks.column<VelocityY>(),
          .radius = disks.column<Radius>(),
          .mass = disks.column<Mass>(),
          .image_x = disks.column<ImageX>(),
          .image_y = disks.column<ImageY>(),
          .substep = duration / static_cast<double>(settings.substeps),
          .substeps = settings.substeps,
          .contact = settings.contact};
}

/// The overlapped disk nearest to a trial point, ties to the lower Id: a choice that no order of visits can change, so
/// that the trajectory does not depend on the grid.
class Partner {
 public:
  Partner(TurnView const& view, std::size_t turning, Vector trial) : view_(view), turning_(turning), trial_(trial) {}

  /// Looks at one candidate; the turning disk itself is no candidate.
  void consider(std::size_t candidate) {
    if (candidate == turning_) return;
    ++checks_;
    double const contact = view_.radius[turning_] + view_.radius[candidate];
    double const distance = squared_length(view_.box.displacement(trial_, view_.position(candidate)));
    if (!(distance < contact * contact)) return;
    if (distance < nearest_ || (distance == nearest_ && view_.id[candidate] < view_.id[partner_])) {
      nearest_ = distance;
      partner_ = candidate;
    }
  }

  [[nodiscard]] bool exists() const { return nearest_ < std::numeric_limits<double>::infinity(); }
  [[nodiscard]] std::size_t index() const { return partner_; }
  [[nodiscard]] std::uint64_t checks() const { return checks_; }

 private:
  TurnView const& view_;
  std::size_t turning_;
  Vector trial_;
  double nearest_ = std::numeric_limits<double>::infinity();
  std::size_t partner_ = 0;
  std::uint64_t checks_ = 0;
};

/// Turns back the velocity component that would carry `trial` through a wall; says whether there was one.
inline bool hits_wall(TurnView const& view, std::size_t i, Vector trial, Tally& tally) {
  if (view.box.is_periodic()) return false;
  double const r = view.radius[i];
  bool is_hit = false;
  auto const reflect = [&](Tally::Wall wall, double& component) {
    ++tally.wall_hits[wall];
    tally.wall_impulse[wall] += 2.0 * view.mass[i] * std::abs(component);
    component = -component;
    is_hit = true;
  };
  if (trial.x < r) reflect(Tally::left, view.velocity_x[i]);
  if (trial.x > view.box.width() - r) reflect(Tally::right, view.velocity_x[i]);
  if (trial.y < r) reflect(Tally::bottom, view.velocity_y[i]);
  if (trial.y > view.box.height() - r) reflect(Tally::top, view.velocity_y[i]);
  return is_hit;
}

/// The elastic rule along b = r_j − r_i at the present positions:
///     Δv_i = −(2 m_j / (m_i + m_j)) (w·b / b²) b,   Δv_j = +(2 m_i / (m_i + m_j)) (w·b / b²) b,   w = v_i − v_j,
/// which reverses the normal part of the relative velocity in the centre-of-mass frame and keeps momentum and energy.
inline void scatter(TurnView const& view, std::size_t i, std::size_t j, Tally& tally) {
  Vector const b = view.box.displacement(view.position(i), view.position(j));
  Vector const w = view.velocity(i) - view.velocity(j);
  double const approach = dot(w, b);
  if (view.contact == Contact::approaching && !(approach > 0.0)) return;
  double const total_mass = view.mass[i] + view.mass[j];
  double const along = 2.0 * approach / (total_mass * squared_length(b));
  Vector const change_i = (-view.mass[j] * along) * b;
  Vector const change_j = (view.mass[i] * along) * b;
  view.velocity_x[i] += change_i.x;
  view.velocity_y[i] += change_i.y;
  view.velocity_x[j] += change_j.x;
  view.velocity_y[j] += change_j.y;
  ++tally.pair_collisions;
  tally.pair_virial -= view.mass[i] * dot(b, change_i);
}

/// Whether a disk may come to an edge of the box in its turn. One that cannot is neither asked for walls nor wrapped.
enum class EdgeOfTurn { may_be_met, is_far };

/// One disk's turn in one time step, the paper's rule: up to `substeps` trial moves; the first that would cross a wall
/// or overlap a disk halts it for this step, and it bounces off what it met. The caller keeps the grid up to date.
///
/// search(partner) must call partner.consider(j) for every disk j that could overlap the trial point; visiting more
/// disks, or any order, gives the same bits.
template <EdgeOfTurn edge = EdgeOfTurn::may_be_met, class Search>
void take_turn(TurnView const& view, std::size_t i, Tally& tally, Search search) {
  ++tally.turns;
  // Kept out of the columns until the turn is over, which spares a way through memory in every sub-step.
  Vector here = view.position(i);
  Vector const way = view.substep * view.velocity(i);
  int crossed_x = 0;
  int crossed_y = 0;
  auto const settle = [&] {
    view.x[i] = here.x;
    view.y[i] = here.y;
    if constexpr (edge == EdgeOfTurn::may_be_met) {
      view.image_x[i] += crossed_x;
      view.image_y[i] += crossed_y;
    }
  };
  for (std::uint64_t m = 0; m < view.substeps; ++m) {
    Vector trial = here + way;
    int trial_crossed_x = crossed_x;
    int trial_crossed_y = crossed_y;
    if constexpr (edge == EdgeOfTurn::may_be_met) {
      if (hits_wall(view, i, trial, tally)) {
        ++tally.blocked_turns;
        break;
      }
      // Wrapping rounds, so it comes before the overlap check: what is checked is what is kept.
      trial = view.box.wrap(trial, trial_crossed_x, trial_crossed_y);
    }
    Partner partner(view, i, trial);
    search(partner);
    tally.distance_checks += partner.checks();
    if (partner.exists()) {
      settle();
      scatter(view, i, partner.index(), tally);
      ++tally.blocked_turns;
      return;
    }
    here = trial;
    crossed_x = trial_crossed_x;
    crossed_y = trial_crossed_y;
  }
  settle();
}

}  // namespace gridlock
