#pragma once

#include <cstddef>
#include <optional>

#include "engine/exact/moving_disk.hpp"
#include "engine/exact/neighbours.hpp"
#include "gridlock/core/target.hpp"

namespace gridlock::exact {

/// The input of a search for the disks that a disk may touch before one of the two leaves the room around its place.
struct PlacesAround {
  Place const* places;   ///< places of all disks
  double const* radius;  ///< radii of all disks; nullptr while all are equal
  Place place;           ///< place of the disk that searches
  double own_radius;
  double rooms;     ///< sum of the rooms of the two disks, in x or y
  double scale;     ///< factor of all radii
  double period_x;  ///< distance between the images of a place; infinite between walls
  double period_y;
  bool has_images;
  double lean = 0.0;  ///< xy of an oblique box
};

/// Indices in a batch, for any width of register.
inline constexpr std::size_t names_per_batch = 16;

/// Kernels that search for neighbours. All return the same indices in the same order.
struct NearPlaces {
  /// Copies the indices in `count` slots to `names`, without empty slots and without `apart`; returns how many. `names`
  /// has space for `count` indices and a batch more; slots up to a batch behind the last are read.
  using Collect = std::size_t (*)(Index const* slots, std::size_t count, Index apart, Index* names);
  /// Keeps in `names` the disks that are near enough; returns how many. `names` has space for a batch more.
  using Keep = std::size_t (*)(PlacesAround const& around, Index* names, std::size_t count);

  Collect collect;
  Keep keep;
};

/// Returns the kernels for the instructions of this target, which the processor must have. They know rectangles only.
NearPlaces near_places_for(Target target);

/// Does the same as NearPlaces::keep in an oblique box, where few disks are near an edge.
std::size_t keep_in_oblique_box(PlacesAround const& around, Index* names, std::size_t count);

/// Returns the AVX-512 kernels, or nothing where this build has none.
std::optional<NearPlaces> near_places_with_avx512();

}  // namespace gridlock::exact
