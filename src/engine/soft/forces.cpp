#include "engine/soft/forces.hpp"

#include <cmath>

namespace gridlock::soft {

ForceRule force_rule(PotentialSettings const& potential, Box const& box, RadiusRange const& radii) {
  double const smallest_sigma = 2.0 * radii.smallest;
  double const largest_sigma = 2.0 * radii.largest;
  PairConstants const constants(potential);
  // Overlaps make forces of at most ε/σ; disks that repel each other without end are stopped by max_push.
  int const digits_below = is_bounded(potential.kind) ? 45 : 34;
  double const unit = std::ldexp(1.0, std::ilogb(potential.energy / smallest_sigma) - digits_below);
  return {.potential = potential,
          .constants = constants,
          .period_x = box.width(),
          .period_y = box.height(),
          .shift = box.shift(),
          .sigma = radii.smallest == radii.largest ? smallest_sigma : 0.0,
          .rounding = unit * 0x1.8p52,
          .max_push = unit * 0x1p46 / (constants.cutoff * largest_sigma)};
}

}  // namespace gridlock::soft
