#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock {

/// Writes what a run has found: series.csv, a table for each distribution, final.xyz, and summary.json as the last one.
///
/// `versions` are those of the programs that have worked on it, `traffic` is that of each process, none where there is
/// one. Errors: RunFailure where a file cannot be written, Error where one of the user has come into the way.
void write_run_results(std::filesystem::path const& directory, std::string const& versions,
                       Configuration const& configuration, std::uint64_t start_hash, RunRecord const& record,
                       FrameSource const& frame, std::vector<Traffic> const& traffic);

}  // namespace gridlock
