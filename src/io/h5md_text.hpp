#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/gzip.hpp"

namespace gridlock {

/// The frames of a trajectory in H5MD as extended XYZ, one after the other: what reads that reads trajectories too, and
/// asks for the frame where there are several. One frame is in memory at a time, as text.
struct TrajectoryText {
  ReadBytes bytes;
  std::vector<std::string> left_out;  ///< names in the file of another program that are not in the text
};

/// Errors: Error as of H5mdReader, also from the function.
TrajectoryText text_of_trajectory(std::filesystem::path const& path);

}  // namespace gridlock
