#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/analysis/dynamics.hpp"

namespace gridlock {

using Agents = std::vector<std::uint32_t>;

/// Errors: Error for a trajectory without agents, other than one time for each frame, positions that are not finite,
/// and kinds with gaps.
void require_trajectory(TrajectoryInMemory const& trajectory);

/// Returns the agents of each kind in ascending order; those of a trajectory without kinds are one kind.
std::vector<Agents> agents_by_kind(TrajectoryInMemory const& trajectory);

/// Returns the points of a frame.
inline PointsInMemory points_of(TrajectoryInMemory const& trajectory, std::size_t frame) {
  double const* const first = trajectory.positions + 2 * frame * trajectory.agents;
  return {.x = first, .y = first + 1, .count = trajectory.agents, .stride = 2};
}

}  // namespace gridlock
