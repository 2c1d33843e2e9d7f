#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock::soft {

/// The numbers of a disk that change in each step, in one cache line.
struct alignas(64) Motion {
  Vector velocity;
  Vector force;
  Vector listed_at;    ///< where the disk was when the lists were made
  double kick = 0.0;   ///< velocity or path that a force gives in one kick; 0 for a fixed disk
  double noise = 0.0;  ///< standard deviation of the noise in a step
};

/// The numbers of a disk that stay, and its image.
struct Identity {
  Id id = 0;
  double radius = 0.0;
  double mass = 0.0;
  std::uint32_t row_in_state = 0;
  std::uint32_t id_index = 0;  ///< its place in the order of the Ids
  std::int32_t image_x = 0;
  std::int32_t image_y = 0;
};

/// The disks of a state in an order of their own. `places` has one point more, infinitely far away, which fills up
/// lists.
struct Disks {
  explicit Disks(State const& state);

  [[nodiscard]] std::size_t size() const { return motions.size(); }
  /// Puts disk order[k] into row k.
  void reorder(std::span<std::uint32_t const> order);
  void write_back(State& state) const;

  UninitializedArray<Vector> places;
  UninitializedArray<Motion> motions;
  UninitializedArray<Identity> identities;
  UninitializedArray<Vector> velocities_in_drag;  ///< for the drag of pairs alone, see DragRule; empty without one
};

}  // namespace gridlock::soft
