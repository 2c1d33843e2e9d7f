#pragma once

#include <filesystem>

namespace gridlock::cli {

/// Runs gridlock-plot to draw the pictures of a run or sweep, and prints its notes. A failure is only a note, since the
/// results are written. `is_quiet` leaves out the note on a missing gridlock-plot.
void draw_pictures(std::filesystem::path const& directory, bool is_quiet = false);

}  // namespace gridlock::cli
