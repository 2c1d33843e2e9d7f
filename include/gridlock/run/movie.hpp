#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "gridlock/io/h5md.hpp"

namespace gridlock {

/// How a trajectory becomes a movie.
struct MovieSettings {
  std::filesystem::path file;  ///< ending in .mp4
  /// "displacement" from the first frame, "psi6" (the angle-free order |ψ6| around each disk), "speed", "direction" (of
  /// velocities or headings), "neighbourhood" (the grid cell), "radius", or the name of a column; empty: displacement for
  /// disks, for other agents their last column of whole numbers, or the direction.
  std::string colour;
  std::uint32_t width = 720;  ///< pixels
  std::uint64_t rate = 25;    ///< frames a second
  std::size_t every = 1;      ///< every how many frames of the trajectory one is shown
};

/// Draws every frame of a trajectory and joins them by the program ffmpeg; the colour bar is the same in all. Agents
/// without a radius get a round mark.
///
/// Errors: Error for a colour that cannot be, a trajectory without positions, or where ffmpeg is not installed;
/// RunFailure where it fails. Cost: two passes over the trajectory, and the pictures on the disk until it is done.
void make_movie(H5mdReader const& trajectory, MovieSettings const& settings);

}  // namespace gridlock
