#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock {

/// Writes the results of a run: series.csv, a table for each distribution, final.xyz, and last summary.json.
///
/// `versions` are those of the programs that carried out the run; `traffic` has an entry for each process, none if
/// there is one process. Errors: RunFailure if a file cannot be written, Error if a file of the user is in the way.
void write_run_results(std::filesystem::path const& directory, std::string const& versions,
                       Configuration const& configuration, std::uint64_t start_hash, RunRecord const& record,
                       FrameSource const& frame, std::vector<Traffic> const& traffic);

}  // namespace gridlock
