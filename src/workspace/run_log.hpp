#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "gridlock/workspace/run_directory.hpp"

namespace gridlock {

/// Writes run.log: a line with the time of day for each event of a run, through all its interruptions. A log that
/// cannot be written does not end the run.
class RunLog {
 public:
  /// Opens the file at the first line. Only the root of the processes writes it.
  RunLog(std::filesystem::path const& directory, std::function<void(Event const&)> on_event, AllProcesses processes);

  void write(Event const& event);

 private:
  AllProcesses processes_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::function<void(Event const&)> on_event_;
};

}  // namespace gridlock
