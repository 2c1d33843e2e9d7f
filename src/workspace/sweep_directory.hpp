#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"

namespace gridlock {

/// The directory of a sweep, with its runs and with results of earlier sweeps.
class SweepDirectory {
 public:
  SweepDirectory(SweepPlan const& plan, SweepSettings const& settings) : plan_(plan), settings_(settings) {}

  /// Returns whether this shard carries out the run with this index.
  [[nodiscard]] bool is_ours(std::size_t run) const;
  [[nodiscard]] std::filesystem::path directory_of(std::size_t run) const;
  /// Returns whether the directory of the run has one, finished or not, that is not to be overwritten.
  [[nodiscard]] bool is_there(std::size_t run) const;
  /// Returns the summary of the run in its directory; nothing if there is no run or it has no summary.
  [[nodiscard]] std::optional<RunSummary> recorded(std::size_t run) const;
  /// Returns an Error if the directory of the run contains a run with other settings; nothing otherwise.
  [[nodiscard]] std::optional<Error> refusal_of(std::size_t run, Setup const& setup) const;

  /// Throws an Error if the directory has a sweep whose common settings differ, since its runs belong in other tables.
  void require_same_base() const;
  /// Creates the directory if it is missing. Errors: Error if it has results that are not a sweep's, or files of the
  /// user with names of tables or of files of the runs.
  void open() const;
  /// Removes old results before runs are repeated, if the user allowed to overwrite.
  void forget_old_results() const;

 private:
  [[nodiscard]] bool is_of_sweep() const;
  void look_and_open() const;
  void protect_runs(std::vector<std::filesystem::path> const& inputs) const;
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const;
  [[nodiscard]] std::string difference_from_recorded(std::size_t run, Setup const& setup) const;

  SweepPlan const& plan_;
  SweepSettings const& settings_;
};

}  // namespace gridlock
