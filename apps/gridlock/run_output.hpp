#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>

#include "gridlock/workspace/run_directory.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

/// The output of the commands that carry out one run, during the run and when it has ended.
class RunOutput {
 public:
  void add_to(CLI::App& verb);

  /// Shows progress and notes, and asks the run to end when the user does.
  [[nodiscard]] gridlock::RunHooks hooks();

  /// Draws the pictures where they were asked for, and says how the run has ended.
  [[nodiscard]] ExitCode finish(gridlock::RunRecord const& record, std::filesystem::path const& directory);

 private:
  void print_progress(gridlock::Progress const& progress);
  void print_end(gridlock::RunRecord const& record, std::filesystem::path const& directory) const;

  bool draws_ = false;
  bool is_quiet_ = false;
  bool is_verbose_ = false;
  bool writes_json_ = false;
  double last_json_ = -1.0;  ///< seconds into the run
  // During the run.
  std::optional<StopSignals> signals_;
  std::optional<ProgressLine> line_;
};

}  // namespace gridlock::cli
