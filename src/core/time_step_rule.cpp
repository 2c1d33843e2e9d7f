#include "gridlock/core/detail/time_step_rule.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace gridlock {

TimeStepCaveats time_step_caveats(Box const& box, Disks const& disks) {
  return time_step_caveats(box, covered_area(disks));
}

TimeStepCaveats time_step_caveats(Box const& box, double covered_area) {
  TimeStepCaveats caveats{.centre_drifts = box.has_images(), .too_dense = std::nullopt};
  double const packing_fraction = covered_area / box.area();
  // The packing fraction of a state differs from the one asked for by the rounding of radii and areas.
  constexpr double rounding = 1e-12;
  if (packing_fraction > TimeStepCaveats::largest_packing_fraction * (1.0 + rounding)) {
    caveats.too_dense = packing_fraction;
  }
  return caveats;
}

std::string in_words(TimeStepCaveats const& caveats) {
  std::vector<std::string> reasons;
  if (caveats.centre_drifts) reasons.emplace_back("the centre of all disks drifts in a periodic box");
  if (caveats.too_dense) {
    reasons.push_back(fmt::format("displacements can be wrong by factors above a packing fraction of {} (here {:.3g})",
                                  TimeStepCaveats::largest_packing_fraction, *caveats.too_dense));
  }
  return fmt::format("{}", fmt::join(reasons, ", and "));
}

}  // namespace gridlock
