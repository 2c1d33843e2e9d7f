#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock {

/// What an engine and the checks of a set-up ask of all disks together.
struct DisksOverview {
  std::uint64_t count = 0;
  RadiusRange radii;
  double largest_speed = 0.0;
  double covered_area = 0.0;

  /// Of these and others.
  void add(DisksOverview const& others);
};

DisksOverview overview_of(Disks const& disks);

}  // namespace gridlock
