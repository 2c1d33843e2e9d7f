#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridlock/grid/detail/agent_pairs.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Returns the pairs of a list, the first points before the second points.
PointPairs in_columns(std::span<AgentPair const> list);

// The functions of neighbour_lists.hpp for an oblique box.

PointPairs find_pairs_in_oblique(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads);
PointPairs find_pairs_of_disks_in_oblique(Box const& box, DiskReach const& reach, PointsInMemory const& centres,
                                          std::span<double const> radius, std::uint64_t threads);

/// Returns the lists of neighbours in pairs, each in the order of its numbers.
NeighbourLists lists_of(PointPairs const& pairs, std::size_t count);

}  // namespace gridlock
