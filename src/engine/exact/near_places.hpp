#pragma once

#include <cstddef>
#include <optional>

#include "engine/exact/moving_disk.hpp"
#include "engine/exact/neighbours.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// Whom a disk may touch before one of the two leaves the room around its place.
struct PlacesAround {
  Place const* places;   ///< of all disks
  double const* radius;  ///< of all disks; nullptr while all are equal
  Place place;           ///< of the disk
  double own_radius;
  double rooms;  ///< of the two, in x or y
  double scale;  ///< of the radii
  double width;
  double height;
  bool is_periodic;
};

/// Names are written and read so many at once, whatever the registers.
inline constexpr std::size_t names_per_batch = 16;

/// Kernels that look for neighbours. All give the same names in the same order.
struct NearPlaces {
  /// Writes the names in some slots, in which there may be nobody, but for one; returns how many. There is room for as
  /// many as slots, and for a batch more. Slots up to a batch behind the last are read.
  using Collect = std::size_t (*)(Index const* slots, std::size_t count, Index apart, Index* names);
  /// Leaves those of the names whose disks are near enough; returns how many. There is room for a batch more.
  using Keep = std::size_t (*)(PlacesAround const& around, Index* names, std::size_t count);

  Collect collect;
  Keep keep;
};

/// The kernels for the instructions of this target, which the processor must have.
NearPlaces near_places_for(Target target);

/// Those of one file; none where this build has none.
std::optional<NearPlaces> near_places_with_avx512();

}  // namespace gridlock::exact
