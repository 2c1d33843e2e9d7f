#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>

#include "gridlock/workspace/run_directory.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

/// Prints the progress and the result of a single run.
class RunOutput {
 public:
  void add_to(CLI::App& verb);

  /// Returns hooks that show progress and notes, and stop the run when the user asks for it.
  [[nodiscard]] gridlock::RunHooks hooks();

  /// Draws the pictures if requested, prints the result of the run and returns the exit code.
  [[nodiscard]] ExitCode finish(gridlock::RunRecord const& record, std::filesystem::path const& directory);

 private:
  void print_progress(gridlock::Progress const& progress);
  void print_end(gridlock::RunRecord const& record, std::filesystem::path const& directory) const;

  bool draws_ = false;
  bool is_quiet_ = false;
  bool is_verbose_ = false;
  bool writes_json_ = false;
  double last_json_ = -1.0;  ///< time of the last line of JSON, in seconds since the start
  // These two exist only during the run.
  std::optional<StopSignals> signals_;
  std::optional<ProgressLine> line_;
};

}  // namespace gridlock::cli
