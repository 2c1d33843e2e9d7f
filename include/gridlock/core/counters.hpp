#pragma once

/// \file
/// Counters of the events of a run, which engines and models update.
///
/// ```cpp
/// Counters counters;
/// add(counters, {.moves = 3, .pair_collisions = 1});
/// ```

#include <array>
#include <cstddef>
#include <cstdint>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// Events counted from the start of the run. Every advance() adds to the counters of its caller, so that the sums do
/// not depend on how many calls of advance() make up the run.
struct Counters {
  enum Wall : std::size_t { left, right, bottom, top };

  std::uint64_t moves = 0;            ///< moves tried (stepped) or disk events handled (exact)
  std::uint64_t halted_moves = 0;     ///< moves that ended at a wall or at another disk
  std::uint64_t pair_collisions = 0;  ///< pairs that collided; one of the two may be fixed
  /// Pairs of disks whose distance was measured; their number depends on the grid, not on the physics.
  std::uint64_t distance_checks = 0;
  std::array<std::uint64_t, 4> wall_hits{};
  std::array<double, 4> wall_impulse{};  ///< Σ |Δp| that disks gave to each wall
  std::uint64_t inner_wall_hits = 0;     ///< hits of walls inside the box
  double inner_wall_impulse = 0.0;       ///< Σ |Δp| that disks gave to these walls
  /// Σ over pairs that collided of −(r_j − r_i)·Δp_i: σ m |v_n| for two equal disks in contact.
  double pair_virial = 0.0;
  /// Ways of self-propelled disks along their headings, in units of that of a free disk from turn to turn of its
  /// heading (exact) or in a sub-step (stepped), and what the sum would be if all were free.
  double swum = 0.0;
  double swum_if_free = 0.0;

  /// Counts free ways.
  void add_swum(std::uint64_t ways) {
    swum += static_cast<double>(ways);
    swum_if_free += static_cast<double>(ways);
  }

  [[nodiscard]] std::uint64_t all_wall_hits() const {
    return wall_hits[0] + wall_hits[1] + wall_hits[2] + wall_hits[3];
  }
};

/// Adds every count and sum of `part` to `sum`.
void add(Counters& sum, Counters const& part);
/// Serializes every count and sum.
void serialize(Archive& archive, Counters& counters);

}  // namespace gridlock
