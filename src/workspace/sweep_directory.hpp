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

/// The directory of a sweep: where its runs are, and what earlier sweeps have left there.
class SweepDirectory {
 public:
  SweepDirectory(SweepPlan const& plan, SweepSettings const& settings) : plan_(plan), settings_(settings) {}

  /// Whether this shard carries out the run.
  [[nodiscard]] bool is_ours(std::size_t run) const;
  [[nodiscard]] std::filesystem::path directory_of(std::size_t run) const;
  /// Whether the run is in its directory already, finished or not.
  [[nodiscard]] bool is_there(std::size_t run) const;
  /// How the run in the directory has ended; nothing where there is none, or none that has ended.
  [[nodiscard]] std::optional<RunSummary> recorded(std::size_t run) const;
  /// Why the run in the directory must not be replaced, if it is one of other settings.
  [[nodiscard]] std::optional<Error> refusal_of(std::size_t run, Setup const& setup) const;

  /// Throws Error for a sweep in the directory that has other settings in common: its runs and these belong in
  /// different tables.
  void require_same_base() const;
  /// Makes the directory where it is missing. Errors: Error where it has results that are not of a sweep, and where
  /// files of the user have the names of tables or of files of the runs.
  void open() const;
  /// Removes what is to be made anew, where that is asked for.
  void forget_old_results() const;

 private:
  [[nodiscard]] bool is_of_sweep() const;
  void protect_runs(std::vector<std::filesystem::path> const& inputs) const;
  [[nodiscard]] std::vector<std::filesystem::path> inputs() const;
  [[nodiscard]] std::string difference_from_recorded(std::size_t run, Setup const& setup) const;

  SweepPlan const& plan_;
  SweepSettings const& settings_;
};

}  // namespace gridlock
