#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

namespace gridlock {

/// run.log: one line for everything that happened to a run, with the time of the day, over all its interruptions.
/// A log that cannot be written stops nothing.
class RunLog {
 public:
  RunLog(std::filesystem::path const& directory, std::function<void(std::string const&)> on_note);

  void note(std::string const& text);

 private:
  std::ofstream file_;
  std::function<void(std::string const&)> on_note_;
};

}  // namespace gridlock
