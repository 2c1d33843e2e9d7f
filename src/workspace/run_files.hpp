#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// How a command with -o DIR and --overwrite, and a function of Python, is told where to go, in place of files of the
/// user.
inline constexpr char const* hint_of_directories =
    "move what is in the way, name another directory, or replace it: --overwrite, in Python overwrite=True";

/// Every file that a run of this configuration may write into its directory, parts of checkpoints left out. A run has
/// these names to itself, also those that it does not write this time: `final.xyz` beside `summary.json` is the end of
/// that run.
std::vector<std::filesystem::path> run_files(std::filesystem::path const& directory,
                                             Configuration const& configuration);

/// Makes sure that results may be written into the directory, under names that are known before, and creates it where
/// it is missing. What is there of other results is for the caller to remove, by remove_results().
/// Errors: Error under the key "-o" where it holds results and nobody said `overwrites`, and those of protect_files()
/// and protect_inputs().
void open_result_directory(std::filesystem::path const& directory, std::vector<std::filesystem::path> results,
                           std::vector<std::filesystem::path> inputs, bool overwrites);

}  // namespace gridlock
