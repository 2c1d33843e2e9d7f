#pragma once

/// \file
/// All neighbours of many points at once, found by the graphics processor.
///
/// ```cpp
/// std::vector<double> const x{0.1, 0.9, 0.5};
/// std::vector<double> const y{0.5, 0.5, 0.5};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 3};
/// Box const box(1.0, 1.0, Edge::periodic);
/// std::size_t const pairs = find_device() ? find_pairs_on_device(box, 0.3, points).size() : 1;
/// ```

#include <cstdint>

#include "gridlock/core/box.hpp"
#include "gridlock/engine/device.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Return what find_pairs() and find_neighbour_lists() return, in the same order.
///
/// `threads` cores search in place of the graphics processor where the box is oblique, where it is periodic and only
/// three cells wide, and where points crowd, as docs/how_to/graphics_processor.md says.
/// Errors: those of find_pairs(); Error with the key "engine.device" where there is no device, or where points and
/// pairs do not fit into its memory. Cost: 60 bytes a point and 4 bytes a neighbour on the device.
PointPairs find_pairs_on_device(Box const& box, double cutoff, PointsInMemory const& points, std::uint64_t threads = 1);
NeighbourLists find_neighbour_lists_on_device(Box const& box, double cutoff, PointsInMemory const& points,
                                              std::uint64_t threads = 1);

}  // namespace gridlock
