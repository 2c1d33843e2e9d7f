#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock {

/// Returns the tables of a run by the names of their files, series.csv first.
std::vector<std::pair<std::string, Table>> result_tables(RunRecord const& record);

/// Returns the text of summary.json.
std::string summary_text(std::string const& versions, Configuration const& configuration, std::uint64_t start_hash,
                         RunRecord const& record, FrameSource const& frame, std::vector<Traffic> const& traffic);

/// Writes the results of a run: series.csv, a table for each distribution, final.xyz, and last summary.json.
///
/// `versions` are those of the programs that carried out the run; `traffic` has an entry for each process, none if
/// there is one process. Errors: RunFailure if a file cannot be written, Error if a file of the user is in the way.
void write_run_results(std::filesystem::path const& directory, std::string const& versions,
                       Configuration const& configuration, std::uint64_t start_hash, RunRecord const& record,
                       FrameSource const& frame, std::vector<Traffic> const& traffic);

}  // namespace gridlock
