#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/run/simulate.hpp"

namespace gridlock {

/// The library's version, as in summary.json.
char const* version();

/// Makes sure a run may write into the directory: it is created where it is missing, and results that are there already
/// are not overwritten unless `overwrites`.
/// Errors: Error under the key "-o".
void open_run_directory(std::filesystem::path const& directory, bool overwrites);

/// Writes everything a run leaves behind:
///
///     config.resolved.toml   the run again, to the bit
///     summary.json           every final observable with its error, state hash, version, seed, timing
///     series.csv             one row per sample
///     <distribution>.csv     speed_distribution, pair_correlation …
///     final.xyz              the last state; start.xyz too where the run began from a file
///
/// Errors: RunFailure where a file cannot be written; every file is written whole or not at all.
void write_run(Setup const& setup, RunResult const& result, std::filesystem::path const& directory);

/// The text of summary.json.
std::string summary_json(Setup const& setup, RunResult const& result);

}  // namespace gridlock
