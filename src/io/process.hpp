#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace gridlock {

/// How a process ended.
struct ProcessResult {
  bool was_found = true;   ///< whether there is such a program
  bool timed_out = false;  ///< whether it was ended at the time limit
  bool succeeded = false;  ///< whether it exited with status 0
  std::string errors;      ///< the first 64 KiB of what it wrote to its standard error
};

/// Runs a program, found through PATH, without a shell, in the given directory and in a process group of its own, so
/// that a Ctrl-C meant for this program does not end it half-way.
///
/// Its standard input is empty and its standard output is thrown away. At the time limit the whole group is killed.
/// Errors: RunFailure where the system refuses a pipe or a process.
ProcessResult run_process(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                          std::chrono::milliseconds time_limit);

}  // namespace gridlock
