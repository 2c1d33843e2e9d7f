#pragma once

#include <filesystem>

#include "io/gzip.hpp"

namespace gridlock {

/// The frames of a trajectory in H5MD as extended XYZ, one after the other: what reads that reads trajectories too, and asks
/// for the frame where there are several. One frame is in memory at a time, as text.
/// Errors: Error as of H5mdReader, also from the function.
ReadBytes text_of_trajectory(std::filesystem::path const& path);

}  // namespace gridlock
