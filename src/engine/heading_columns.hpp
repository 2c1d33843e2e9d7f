#pragma once

#include <span>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/engine/propulsion.hpp"

namespace gridlock {

/// Calls use() with a frame that has the columns heading_x and heading_y too, if disks propel themselves. The headings
/// are the directions of the velocities; that of a disk at rest is (0, 0).
void give_frame_with_headings(PropulsionSettings const& propulsion, FrameSource const& of_world, UseFrame const& use);

/// The same for these headings of all disks in the order of the Ids; if there are none, for those of the velocities.
void give_frame_with_headings(PropulsionSettings const& propulsion, std::span<Vector const> headings,
                              FrameSource const& of_world, UseFrame const& use);

}  // namespace gridlock
