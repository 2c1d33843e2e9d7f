#pragma once

#include <string>

#include "gridlock/core/frame_source.hpp"
#include "io/file.hpp"

namespace gridlock {

/// Appends a frame as write_xyz() writes it; frames one after the other make a film.
void append_xyz(FrameSource const& frame, AtomicFile& file);

/// The same text in memory.
std::string xyz_text(FrameSource const& frame);

}  // namespace gridlock
