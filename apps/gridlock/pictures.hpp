#pragma once

#include <filesystem>

namespace gridlock::cli {

/// Lets the program gridlock-plot draw the pictures of a run or sweep, and prints its notes. What keeps it from drawing is a note
/// too: the results are written.
void draw_pictures(std::filesystem::path const& directory);

}  // namespace gridlock::cli
