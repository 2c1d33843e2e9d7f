#include "engine/soft/forces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gridlock::soft {

namespace {

/// Forces of pairs are at most 2^46 of their unit; this many binary digits of ε/σ, with the smallest σ, lie above it.
constexpr int digits_above_unit = 45;

/// Returns how many binary digits below ε/σ the unit of forces lies.
int digits_below(PotentialSettings const& potential, PairLaw const& law, RadiusRange const& radii, bool has_drag) {
  // Disks that repel each other without end, and drags, are stopped by a largest force.
  constexpr int least = 34;
  if (has_drag) return least;
  // Overlaps make forces of at most ε/σ.
  if (is_bounded(potential.kind)) return digits_above_unit;
  if (potential.kind != PairPotential::table) return least;
  // All forces of a table are known; the factor 4 is for the rounding of ε/σ to a power of two, and
  // for swings of the spline between rows.
  double const steepest = 4.0 * law.table().largest_push() * law.cutoff() * radii.largest / radii.smallest;
  constexpr int most = 300;
  return std::clamp(digits_above_unit - (steepest > 0.0 ? std::ilogb(steepest) : 0), least, most);
}

}  // namespace

ForceRule force_rule(PotentialSettings const& potential, Box const& box, RadiusRange const& radii, bool has_drag) {
  double const smallest_sigma = 2.0 * radii.smallest;
  double const largest_sigma = 2.0 * radii.largest;
  PairConstants const constants(potential);
  PairLaw law(potential);
  double const unit =
      std::ldexp(1.0, std::ilogb(potential.energy / smallest_sigma) - digits_below(potential, law, radii, has_drag));
  return {.kind = potential.kind,
          .law = std::move(law),
          .constants = constants,
          .period_x = box.width(),
          .period_y = box.height(),
          .shift = box.shift(),
          .sigma = radii.smallest == radii.largest ? smallest_sigma : 0.0,
          .rounding = unit * 0x1.8p52,
          .max_push = unit * 0x1p46 / (constants.cutoff * largest_sigma)};
}

}  // namespace gridlock::soft
