#pragma once

#include <optional>
#include <string>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Where the paper's rule, which has a time step, is known to mislead. See docs/explanation/paper.md, "Physics, or the
/// time step?" and "In a periodic box".
struct TimeStepCaveats {
  static constexpr double largest_packing_fraction = 0.72;  ///< above it displacements can be wrong by factors

  bool centre_drifts = false;       ///< that of all disks, in a periodic box
  std::optional<double> too_dense;  ///< a packing fraction above the largest one

  [[nodiscard]] bool any() const { return centre_drifts || too_dense; }
};

TimeStepCaveats time_step_caveats(Box const& box, Disks const& disks);
TimeStepCaveats time_step_caveats(Box const& box, double covered_area);

/// As a part of a sentence; empty where there is none.
std::string in_words(TimeStepCaveats const& caveats);

}  // namespace gridlock
