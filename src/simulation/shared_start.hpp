#pragma once

#include <functional>

#include "gridlock/core/disks.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "io/xyz_reader.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

/// A file with the disks at the start of a run on several processes.
struct StartFile {
  xyz::Reader* reader = nullptr;  ///< reader on the root, after the header
  /// Compares the disks with the settings; may throw Error. Only the root calls it.
  std::function<void(StartFileSummary const&)> take_summary;
};

/// The rows of a start file that belong to one process; the Ids ascend over all processes.
struct RowsOfFile {
  State own;  ///< disks of this process, with box and clock of the file
  bool has_velocities = false;
};

/// Reads a start file on the root and distributes its rows piece by piece, so that no process holds all. The processes
/// then sort the rows by Id. All processes call it. Errors: Error in all processes: those of read_xyz(), with line
/// numbers, and of take_summary.
RowsOfFile read_together(Communicator& processes, DisksSettings const& settings, StartFile const& file);

}  // namespace gridlock
