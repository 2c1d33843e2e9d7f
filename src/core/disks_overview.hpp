#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// Numbers over all disks that an engine and the checks of a start need.
struct DisksOverview {
  std::uint64_t count = 0;
  RadiusRange radii;
  double largest_speed = 0.0;
  double covered_area = 0.0;

  /// Adds the numbers of other disks.
  void add(DisksOverview const& others);
};

DisksOverview overview_of(Disks const& disks);

/// Returns the mean diameter. Contract: there are disks.
double mean_diameter(Disks const& disks);

}  // namespace gridlock
