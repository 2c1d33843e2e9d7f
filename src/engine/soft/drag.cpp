#include "engine/soft/drag.hpp"

#include <algorithm>
#include <cmath>

namespace gridlock::soft {

namespace {

/// Adds up the drags on disks of a band.
class SumOfDrags {
 public:
  SumOfDrags(DragRule const& rule, Box const& box, Disks const& disks) : rule_(rule), box_(box), disks_(disks) {}

  [[nodiscard]] Vector on(Band const& band, std::size_t k) {
    std::size_t const row = band.first + k;
    Vector sum;
    for_each_neighbour(band, k, box_, disks_, [&](std::uint32_t other, Vector d) {
      double const square = squared_length(d);
      double const contact = disks_.identities[row].radius + disks_.identities[other].radius;
      if (!(square < contact * contact) || square == 0.0) return;
      Vector difference = disks_.velocities_in_drag[row] - disks_.velocities_in_drag[other];
      difference.x += rule_.shear_rate * d.y;
      Vector const drag = rule_.drag.force(d, difference);
      largest_ = std::max({largest_, std::abs(drag.x), std::abs(drag.y)});
      sum = sum + Vector{rounded(drag.x, rule_.rounding), rounded(drag.y, rule_.rounding)};
    });
    return sum;
  }
  [[nodiscard]] double largest() const { return largest_; }

 private:
  DragRule const& rule_;
  Box const& box_;
  Disks const& disks_;
  double largest_ = 0.0;
};

}  // namespace

DragRule drag_rule(EngineSettings const& settings, ForceRule const& forces, RadiusRange const& radii) {
  return {.drag = settings.pair_drag,
          .shear_rate = settings.flow.shear_rate,
          .rounding = forces.rounding,
          .largest_drag = forces.max_push * forces.constants.cutoff * 2.0 * radii.largest};
}

void take_velocities(Band const& band, Disks& disks) {
  for (std::size_t row = band.first; row < band.end; ++row) disks.velocities_in_drag[row] = disks.motions[row].velocity;
}

void predict_velocities(Band const& band, Disks& disks) {
  for (std::size_t row = band.first; row < band.end; ++row) {
    Motion const& motion = disks.motions[row];
    disks.velocities_in_drag[row] = motion.velocity + motion.kick * motion.force;
  }
}

double add_drags(DragRule const& rule, Box const& box, Band const& band, Disks& disks) {
  SumOfDrags drags(rule, box, disks);
  for (std::size_t k = 0; k < band.is_at_edge.size(); ++k) {
    Motion& motion = disks.motions[band.first + k];
    motion.force = motion.force + drags.on(band, k);
  }
  return drags.largest();
}

double kick_with_drags(DragRule const& rule, Box const& box, Band const& band, Disks& disks) {
  SumOfDrags drags(rule, box, disks);
  for (std::size_t k = 0; k < band.is_at_edge.size(); ++k) {
    Motion& motion = disks.motions[band.first + k];
    motion.velocity = motion.velocity + motion.kick * (motion.force + drags.on(band, k));
  }
  return drags.largest();
}

}  // namespace gridlock::soft
