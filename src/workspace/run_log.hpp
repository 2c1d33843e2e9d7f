#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "gridlock/workspace/run_directory.hpp"

namespace gridlock {

/// run.log: one line for everything that happened to a run, with the time of the day, over all its interruptions.
/// A log that cannot be written does not end the run.
class RunLog {
 public:
  /// The file is opened at the first line. The root of the processes that share the run writes it.
  RunLog(std::filesystem::path const& directory, std::function<void(Event const&)> on_event, AllProcesses processes);

  void write(Event const& event);

 private:
  AllProcesses processes_;
  std::filesystem::path path_;
  std::ofstream file_;
  std::function<void(Event const&)> on_event_;
};

}  // namespace gridlock
