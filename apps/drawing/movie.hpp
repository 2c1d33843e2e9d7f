#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/run.hpp"

namespace gridlock {

/// How a trajectory becomes a movie.
struct MovieSettings {
  std::filesystem::path file;         ///< ending in .mp4, .mov, .mkv (H.264), .webm (VP9) or .gif
  std::filesystem::path source = {};  ///< of the trajectory, which is never replaced; empty where it has none
  /// "displacement" from the first frame, "psi6" (the angle-free order |ψ6| around each disk), "speed", "direction" (of
  /// velocities or headings), "neighbourhood" (the grid cell), "radius", or the name of a column; empty: displacement
  /// for disks, for other agents their last column of whole numbers, or the direction.
  std::string colour = {};
  std::uint32_t width = 720;  ///< pixels
  std::uint64_t rate = 25;    ///< frames a second
  std::size_t every = 1;      ///< every how many frames of the trajectory one is shown; not 0 (asserted)
  bool overwrites = false;    ///< whether a file that make_movie() has not made may be replaced
};

struct MovieProgress {
  std::size_t drawn = 0;
  std::size_t all = 0;
  double seconds = 0.0;
};

/// Called before each frame; false stops the movie.
using OnMovieProgress = std::function<bool(MovieProgress const&)>;

/// Draws every frame of a trajectory and gives it to the program ffmpeg; the colour bar is the same in all. Agents
/// without a radius get a round mark.
///
/// The file appears under its name when the movie is whole; a movie that is stopped or fails leaves none. Returns
/// whether it finished or was interrupted.
/// Errors: Error for a name or place that cannot be, before anything is drawn, for a colour that cannot be, a
/// trajectory without frames or positions, or where ffmpeg is not installed; RunFailure where it fails. Cost: two
/// passes over the trajectory.
RunStatus make_movie(H5mdReader const& trajectory, MovieSettings const& settings,
                     OnMovieProgress const& on_progress = {});

}  // namespace gridlock
