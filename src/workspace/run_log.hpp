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
  /// The file is opened at the first line.
  RunLog(std::filesystem::path const& directory, std::function<void(LogLine const&)> on_note);

  void write(LogLevel level, std::string const& text);
  void info(std::string const& text) { write(LogLevel::info, text); }
  void note(std::string const& text) { write(LogLevel::note, text); }
  void warn(std::string const& text) { write(LogLevel::warning, text); }

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  std::function<void(LogLine const&)> on_note_;
};

}  // namespace gridlock
