#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "gridlock/simulation/configuration.hpp"

namespace gridlock {

/// Hint on files in the way, for commands with -o DIR and --overwrite and for functions of Python.
inline constexpr char const* hint_of_directories =
    "move what is in the way, name another directory, or replace it: --overwrite, in Python overwrite=True";

/// Returns all files that a run of this configuration may write into its directory, other than parts of checkpoints.
/// All these names belong to the run, even if it does not write them: a `final.xyz` beside `summary.json` must be the
/// final state of that run.
std::vector<std::filesystem::path> run_files(std::filesystem::path const& directory,
                                             Configuration const& configuration);

/// Checks that results with these names may be written into a directory, and creates the directory if it is missing.
/// The caller removes other results there by remove_results(). Errors: Error under the key "-o" if the directory has
/// results and `overwrites` is false, and those of protect_files() and protect_inputs().
void open_result_directory(std::filesystem::path const& directory, std::vector<std::filesystem::path> results,
                           std::vector<std::filesystem::path> inputs, bool overwrites);

}  // namespace gridlock
