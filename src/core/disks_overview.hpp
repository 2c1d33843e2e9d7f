#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// The numbers of all disks together that an engine and the checks of a set-up ask for.
struct DisksOverview {
  std::uint64_t count = 0;
  RadiusRange radii;
  double largest_speed = 0.0;
  double covered_area = 0.0;

  /// Adds those of other disks.
  void add(DisksOverview const& others);
};

DisksOverview overview_of(Disks const& disks);

}  // namespace gridlock
