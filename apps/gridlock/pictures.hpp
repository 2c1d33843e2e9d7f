#pragma once

#include <filesystem>

namespace gridlock::cli {

/// Lets the program gridlock-plot draw the pictures of a run or sweep, and prints its notes. What keeps it from drawing
/// is a note too: the results are written. `is_quiet` leaves out the note on a missing program.
void draw_pictures(std::filesystem::path const& directory, bool is_quiet = false);

}  // namespace gridlock::cli
