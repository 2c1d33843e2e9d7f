#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/descriptor.hpp"

namespace gridlock {

/// The outcome of a process.
struct ProcessResult {
  bool was_found = true;   ///< whether the program exists
  bool timed_out = false;  ///< whether the process was killed at the time limit
  bool succeeded = false;  ///< whether the process exited with status 0
  std::string errors;      ///< first 64 KiB of standard error
};

/// The standard input of a process.
enum class ProcessInput {
  nothing,
  pipe,  ///< the bytes given to write()
};

/// Runs a program that is found through PATH, without a shell, in a directory and in a process group of its own, so
/// that a Ctrl-C for this program does not interrupt it.
///
/// Standard output is discarded. The destructor kills the whole group if it still runs; the system kills the program
/// when the thread that started it ends, for example by a kill of this process. Errors: RunFailure if the system
/// refuses a pipe or a process.
class ChildProcess {
 public:
  ChildProcess(std::vector<std::string> const& arguments, std::filesystem::path const& directory, ProcessInput input);
  ~ChildProcess();
  ChildProcess(ChildProcess const&) = delete;
  ChildProcess& operator=(ChildProcess const&) = delete;

  /// Writes bytes to standard input; returns false if the program stops reading or the time limit passes first.
  [[nodiscard]] bool write(std::string_view bytes, std::chrono::milliseconds time_limit);

  /// Closes standard input and waits for the end of the program. At the time limit the whole group is killed.
  ProcessResult wait(std::chrono::milliseconds time_limit);

 private:
  void read_errors();
  void kill_group();

  Descriptor input_;   ///< our end of standard input
  Descriptor errors_;  ///< our end of standard error
  pid_t id_ = -1;      ///< process id; -1 if not started or ended
  ProcessResult result_;
};

/// Runs a program to its end by a ChildProcess with empty standard input.
ProcessResult run_process(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                          std::chrono::milliseconds time_limit);

}  // namespace gridlock
