#pragma once

#include <functional>

#include "gridlock/core/disks.hpp"
#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "io/xyz_reader.hpp"
#include "simulation/start_file.hpp"

namespace gridlock {

/// What the leader knows of a file that disks of all ranks start from.
struct StartFile {
  xyz::Reader& reader;  ///< of which the head has been read
  /// Compares all disks with the settings, and may refuse them.
  std::function<void(StartFileSummary const&)> take_summary;
};

/// What one of several ranks has of a start file: its rows in the order of the Ids of all.
struct RowsOfFile {
  RowDivision rows;
  State own;  ///< with the box and the clock of the file
  bool has_velocities = false;
};

/// The leader, which alone has the file, reads it piece by piece and hands it out: nobody ever has all rows. The Ids
/// may be in any order; ranks sort them. All call it. Errors: Error on all of them; the leader's are those of
/// read_xyz(), with their place, and of take_summary.
RowsOfFile read_on_ranks(Communicator& ranks, DisksSettings const& settings, StartFile const* file);

}  // namespace gridlock
