#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gridlock {

/// What was drawn, and why something was not.
struct Pictures {
  std::vector<std::filesystem::path> files;
  std::vector<std::string> notes;
};

/// Draws the pictures of a finished run or sweep from the files of its directory alone, each as SVG and PNG.
///
/// A run: start, final (coloured by displacement), displacement, speed_distribution, pair_correlation. A run of a model:
/// final, and every column of its series. A sweep: the
/// means of a few observables against the swept number with the most values, one curve for each combination of the
/// others. Plots keep their gnuplot script beside them.
/// Errors: Error where the directory holds neither; a picture that cannot be drawn is only noted.
/// Error for a colour that the agents do not have, before anything is drawn.
/// `colour` is that of the picture final, see MovieSettings; a file of one frame knows no displacement of a model's
/// agents. `makes_pdf` writes each as PDF too.
Pictures draw_results(std::filesystem::path const& directory, std::string const& colour = {}, bool makes_pdf = false);

}  // namespace gridlock
