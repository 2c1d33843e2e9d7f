#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/engine/grains.hpp"

namespace gridlock::exact {

/// The energy that collisions lose: the normal part of the relative velocity becomes −e times itself.
struct Losses {
  std::size_t kinds = 1;              ///< kinds of disks that e tells apart
  std::vector<double> of_pairs{1.0};  ///< e of two disks of the kinds a and b, at a · kinds + b; one may be fixed
  std::vector<double> of_walls{1.0};  ///< e of a disk of a kind and a wall
  double contact_time = 0.0;          ///< e is 1 for a disk that collided a shorter time ago
  bool exist = false;                 ///< whether some e is not 1
};

/// Radius and mass of each kind of disk, in ascending order.
using Kinds = std::vector<std::pair<double, double>>;
Kinds kinds_of(Disks const& disks);

/// Returns the losses of settings for these disks.
/// Errors: Error where numbers are given by kind and are not those of all kinds.
Losses losses_for(CollisionSettings const& settings, Disks const& disks);

}  // namespace gridlock::exact
