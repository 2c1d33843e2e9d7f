#include "gridlock/core/detail/time_step_rule.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace gridlock {

std::string where_time_steps_mislead(Box const& box, Disks const& disks) {
  constexpr double dense = 0.72;
  std::vector<std::string> reasons;
  if (box.is_periodic()) reasons.emplace_back("the centre of all disks drifts in a periodic box");
  double const packing_fraction = covered_area(disks) / box.area();
  if (packing_fraction > dense) {
    reasons.push_back(fmt::format("displacements can be wrong by factors above a packing fraction of {} (here {:.3g})",
                                  dense, packing_fraction));
  }
  return fmt::format("{}", fmt::join(reasons, ", and "));
}

}  // namespace gridlock
