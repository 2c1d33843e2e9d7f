#pragma once

#include <optional>
#include <string>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock {

/// The conditions under which the rule of the paper, which moves disks in time steps, gives wrong physics. See
/// docs/explanation/paper.md, "Physics, or the time step?" and "In a periodic box".
struct TimeStepCaveats {
  static constexpr double largest_packing_fraction = 0.72;  ///< above this value displacements can be wrong by factors

  bool centre_drifts = false;       ///< the centre of mass of all disks moves, in a periodic box
  std::optional<double> too_dense;  ///< the packing fraction, if it is above largest_packing_fraction

  [[nodiscard]] bool any() const { return centre_drifts || too_dense; }
};

TimeStepCaveats time_step_caveats(Box const& box, Disks const& disks);
TimeStepCaveats time_step_caveats(Box const& box, double covered_area);

/// Returns the conditions that hold as a part of a sentence; empty if none holds.
std::string in_words(TimeStepCaveats const& caveats);

}  // namespace gridlock
