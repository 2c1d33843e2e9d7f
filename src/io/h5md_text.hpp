#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/gzip.hpp"

namespace gridlock {

/// The frames of a trajectory in H5MD as extended XYZ, one after the other. Readers of extended XYZ thereby read
/// trajectories too, with the choice of a frame. One frame at a time is in memory, as text.
struct TrajectoryText {
  ReadBytes bytes;
  std::vector<std::string> left_out;  ///< names of data in another program's file that the text omits
};

/// Opens a trajectory. Errors: those of H5mdReader, also when the text is read.
TrajectoryText text_of_trajectory(std::filesystem::path const& path);

}  // namespace gridlock
