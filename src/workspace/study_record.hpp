#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "gridlock/workspace/verify.hpp"

namespace gridlock {

/// Returns whether a directory has the record of a study: a table runs.csv with settings and state hashes.
bool has_study_record(std::filesystem::path const& directory);

/// Carries out runs of a study again and compares their last state hashes. Calls `on_line` with a sentence on each that
/// differs, and with one on all.
VerifiedRuns verify_study(std::filesystem::path const& directory, VerifyOptions const& options,
                          std::function<void(std::string const&)> const& on_line);

}  // namespace gridlock
