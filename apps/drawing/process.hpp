#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/descriptor.hpp"

namespace gridlock {

/// How a process ended.
struct ProcessResult {
  bool was_found = true;   ///< whether there is such a program
  bool timed_out = false;  ///< whether it was ended at the time limit
  bool succeeded = false;  ///< whether it exited with status 0
  std::string errors;      ///< the first 64 KiB of what it wrote to its standard error
};

/// The standard input of a process.
enum class ProcessInput {
  nothing,
  pipe,  ///< what write() gives it
};

/// A program at work, found through PATH and started without a shell, in the given directory and in a process group of
/// its own, so that a Ctrl-C meant for this program does not interrupt it.
///
/// Its standard output is thrown away. Where it still runs at the end of the object, its whole group is killed; the
/// program itself is killed too when the thread that began it ends, by a kill of this process or otherwise.
/// Errors: RunFailure where the system refuses a pipe or a process.
class ChildProcess {
 public:
  ChildProcess(std::vector<std::string> const& arguments, std::filesystem::path const& directory, ProcessInput input);
  ~ChildProcess();
  ChildProcess(ChildProcess const&) = delete;
  ChildProcess& operator=(ChildProcess const&) = delete;

  /// Gives it the bytes; false where it stopped reading, or has not read them all within the time limit.
  [[nodiscard]] bool write(std::string_view bytes, std::chrono::milliseconds time_limit);

  /// Ends its input and waits for its end. At the time limit the whole group is killed.
  ProcessResult wait(std::chrono::milliseconds time_limit);

 private:
  void read_errors();
  void kill_group();

  Descriptor input_;   ///< where write() writes
  Descriptor errors_;  ///< where its standard error comes out
  pid_t id_ = -1;      ///< -1: never begun, or ended
  ProcessResult result_;
};

/// Runs a program to its end, as ChildProcess does, with an empty standard input.
ProcessResult run_process(std::vector<std::string> const& arguments, std::filesystem::path const& directory,
                          std::chrono::milliseconds time_limit);

}  // namespace gridlock
