#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/run.hpp"

namespace gridlock {

/// Settings of a movie.
struct MovieSettings {
  std::filesystem::path file;         ///< ends in .mp4, .mov, .mkv (H.264), .webm (VP9) or .gif
  std::filesystem::path source = {};  ///< file of the trajectory, which is never replaced; empty if it has none
  /// "displacement" from the first frame, "psi6" (|ψ6| of each disk), "speed", "direction" (of velocities or headings),
  /// "neighbourhood" (the grid cell), "radius", or the name of a column; empty: displacement for disks, for other
  /// agents the last column of whole numbers, or the direction.
  std::string colour = {};
  std::uint32_t width = 720;  ///< in pixels
  std::uint64_t rate = 25;    ///< frames per second
  std::size_t every = 1;      ///< shows every n-th frame of the trajectory; not 0 (asserted)
  bool overwrites = false;    ///< whether a file may be replaced that make_movie() did not make
};

struct MovieProgress {
  std::size_t drawn = 0;
  std::size_t all = 0;
  double seconds = 0.0;
};

/// Called before each frame; a result of false stops the movie.
using OnMovieProgress = std::function<bool(MovieProgress const&)>;

/// Draws every frame of a trajectory and encodes them by the program ffmpeg, with the same colour bar in all frames.
/// Agents without a radius get a round mark. Walls inside the box are those of the settings that the trajectory keeps.
///
/// The file appears when the movie is complete; a stopped or failed movie leaves no file. Returns whether the movie is
/// finished or interrupted. Errors: Error before drawing for an invalid file name or directory, an invalid colour, a
/// trajectory without frames or positions, or a missing ffmpeg; RunFailure if ffmpeg fails. Cost: two passes over the
/// trajectory.
RunStatus make_movie(H5mdReader const& trajectory, MovieSettings const& settings,
                     OnMovieProgress const& on_progress = {});

}  // namespace gridlock
