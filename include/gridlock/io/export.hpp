#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "gridlock/io/h5md.hpp"

namespace gridlock {

/// What a trajectory is turned into.
enum class ExportFormat {
  xyz,  ///< extended XYZ, all frames in one file: OVITO, ASE
  vtk,  ///< a .pvd file that lists a .vtp file for each frame, in a directory beside it: ParaView
  csv,  ///< one row for each agent of each frame: step, time, id and the columns
};

struct ExportSettings {
  ExportFormat format = ExportFormat::xyz;
  std::filesystem::path file;  ///< with the extension .xyz, .pvd or .csv
  std::size_t every = 1;       ///< every how many frames one is taken
};

/// The files that export_trajectory() writes, the one to open first.
std::vector<std::filesystem::path> exported_files(H5mdReader const& trajectory, ExportSettings const& settings);

/// Writes the frames of a trajectory in another format; returns exported_files().
/// Errors: Error for damage, RunFailure where a file cannot be written. Cost: one frame in memory.
///
/// ```cpp
/// H5mdReader const trajectory("trajectory.h5");
/// export_trajectory(trajectory, {.format = ExportFormat::vtk, .file = "frames.pvd", .every = 10});
/// ```
std::vector<std::filesystem::path> export_trajectory(H5mdReader const& trajectory, ExportSettings const& settings);

}  // namespace gridlock
