#pragma once

/// \file
/// Sweeps: a run for every combination of listed values. Sweeps can be resumed, and divided into shards.
///
/// ```cpp
/// SweepPlan const plan = plan_sweep(SettingsFile::from_path("scenes/density_sweep.toml"));
/// SweepResult const result = run_sweep(plan, {.directory = "results/densities"});
/// std::vector<double> const fractions = result.rows.numbers("disks.packing_fraction");
/// ```

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/io/settings_file.hpp"
#include "gridlock/io/table.hpp"

namespace gridlock {

/// One run of a sweep: its name, and its values of the swept settings.
struct SweepRun {
  std::string name;                 ///< name of the directory, made of the values
  std::vector<std::string> values;  ///< in TOML, one for each key of the plan
  SettingsFile settings;
};

/// The runs of a sweep: every combination of the listed values, the last list varying fastest.
struct SweepPlan {
  std::vector<std::string> keys;
  std::map<std::string, std::string> base;  ///< key → TOML value of settings that all runs share, except engine.threads
  std::vector<SweepRun> runs;
};

/// Makes the plan of a sweep from the table `[sweep]` of a file.
/// Errors: Error without a table `[sweep]`, for a list that cannot be used, and for every value that its setting does
/// not accept (unknown key, wrong type, out of bounds). Whether a set-up is possible is checked only when it is made.
SweepPlan plan_sweep(SettingsFile file);

/// The progress of a sweep.
struct SweepProgress {
  std::size_t finished = 0;  ///< runs that ended, also those that failed
  std::size_t all = 0;
  double fraction = 0.0;  ///< share of the whole work
  double seconds = 0.0;
};

/// A part of a sweep for one of several machines or jobs: run number k of the plan, counted from 0, belongs to shard
/// k mod count + 1.
struct Shard {
  std::size_t number = 1;  ///< from 1 to count
  std::size_t count = 1;
};

/// The processes that carry out one sweep together, in the program `gridlock-mpi`.
class SweepCrew;

/// The directory, threads and options of a sweep.
struct SweepSettings {
  std::filesystem::path directory;
  bool overwrites = false;     ///< whether all runs are made again, also finished ones
  std::optional<Shard> shard;  ///< empty: the whole sweep
  unsigned threads = 0;        ///< runs at a time; 0: one for each core that the process may use
  /// Called from any thread, one call at a time; if it returns false, every run stops after its present chunk.
  std::function<bool(SweepProgress const&)> on_progress;
  SweepCrew* crew = nullptr;                 ///< processes that take part; nullptr: this process alone
  std::filesystem::path settings_file = {};  ///< the file of the plan; never replaced
};

/// The results of a sweep, besides the run directories in runs/.
struct SweepResult {
  Table rows;  ///< sweep.csv, one row a run in the order of the plan: values, status, state_hash, every result
  /// means.csv: averages over runs that differ only in run.seed, with the larger of the errors from their scatter and
  /// from the errors of the runs.
  Table means;
  std::size_t failures = 0;           ///< runs that failed or could not be set up
  std::size_t interruptions = 0;      ///< runs stopped early or never begun
  std::vector<std::string> messages;  ///< the reasons, one for each failure
  std::vector<std::string> notes;     ///< notes on settings without effect in any run, and on runs that means leave out
};

/// Runs a plan on all cores, the longest runs first, and writes sweep.csv and means.csv; draw_results() draws them.
///
/// In a directory with an earlier sweep, finished runs are kept and interrupted runs resume: after values have been
/// added to the lists, only the new runs are made. A shard writes no tables; collect_sweep() does. The results do not
/// depend on the number of threads, shards or interruptions. A run that fails is recorded with its message, and the
/// other runs continue. Errors: Error, before anything is written, if no run can be set up, or if the directory cannot
/// be used, is in use, or has one of the runs with other settings; RunFailure if results cannot be written.
SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings);

/// Combines the shards of a sweep from one or several directories: copies runs that `into` lacks, the most advanced
/// copy of each, and writes plan.json, sweep.csv and means.csv. Errors: Error for a directory without a sweep, for
/// sweeps of different settings, if a directory is in use, and if a file that Gridlock has not written would be
/// replaced without `overwrites`.
SweepResult collect_sweep(std::vector<std::filesystem::path> const& directories, std::filesystem::path const& into,
                          bool overwrites = false);

}  // namespace gridlock
