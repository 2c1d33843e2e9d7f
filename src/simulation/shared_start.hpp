#pragma once

#include <functional>

#include "gridlock/core/disks.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "io/xyz_reader.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

/// A file that the disks of all processes start from.
struct StartFile {
  xyz::Reader* reader = nullptr;  ///< of the root, which has read the head
  /// Compares all disks with the settings, and may refuse them; the root calls it.
  std::function<void(StartFileSummary const&)> take_summary;
};

/// The part of a start file that one of several processes has: its rows in the order of the Ids of all.
struct RowsOfFile {
  State own;  ///< with the box and the clock of the file
  bool has_velocities = false;
};

/// The root reads the file piece by piece and hands it out: no process ever has all rows. The Ids may be in any order;
/// the processes sort them. All call it. Errors: Error on all of them: those of read_xyz(), with their place, and of
/// take_summary.
RowsOfFile read_together(Communicator& processes, DisksSettings const& settings, StartFile const& file);

}  // namespace gridlock
