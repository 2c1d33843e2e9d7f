#pragma once

#include <string>

#include "gridlock/core/frame_source.hpp"
#include "io/file.hpp"

namespace gridlock {

/// Appends a frame as write_xyz() writes it; several frames in a file form a trajectory.
void append_xyz(FrameSource const& frame, AtomicFile& file);

/// Returns the text of a frame, as append_xyz() writes it.
std::string xyz_text(FrameSource const& frame);

}  // namespace gridlock
