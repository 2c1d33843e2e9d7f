#pragma once

/// \file
/// Sweeps: runs of every combination of listed values, resumable, in shards.
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

/// One run of a sweep: what it is called, and the values it has of the swept settings.
struct SweepRun {
  std::string name;                 ///< a directory name made of the values
  std::vector<std::string> values;  ///< TOML, one for each key of the plan
  SettingsFile settings;
};

/// Every combination of the listed values, the last list varying fastest.
struct SweepPlan {
  std::vector<std::string> keys;
  std::map<std::string, std::string> base;  ///< dotted key → TOML of what all runs share, engine.threads left out
  std::vector<SweepRun> runs;
};

/// Expands the table `[sweep]` of a file.
/// Errors: Error without such a table, where a list cannot be used, and for every value that its setting does not
/// accept (unknown key, wrong type, out of bounds); whether the set-ups can exist is seen when they are made.
SweepPlan plan_sweep(SettingsFile file);

/// How far a sweep has come.
struct SweepProgress {
  std::size_t finished = 0;  ///< runs that ended, well or not
  std::size_t all = 0;
  double fraction = 0.0;  ///< of the whole work
  double seconds = 0.0;
};

/// A part of a sweep for one of several machines or jobs: run number k of the plan, counted from 0, belongs to shard
/// k mod count + 1.
struct Shard {
  std::size_t number = 1;  ///< from 1 to count
  std::size_t count = 1;
};

/// Processes that carry out one sweep together, as the program `gridlock-mpi` makes one.
class SweepCrew;

/// How a sweep is carried out.
struct SweepSettings {
  std::filesystem::path directory;
  bool overwrites = false;     ///< whether everything is run again, also what is finished
  std::optional<Shard> shard;  ///< left out: the whole sweep
  unsigned threads = 0;        ///< runs at a time; 0: one for each core that the process may use
  /// Called from any thread, one call at a time; returning false stops every run after its present chunk.
  std::function<bool(SweepProgress const&)> on_progress;
  SweepCrew* crew = nullptr;                 ///< others that take part; left out: this process alone
  std::filesystem::path settings_file = {};  ///< the plan was made from; never replaced
};

/// The results of a sweep, besides one run directory in runs/ for each run.
struct SweepResult {
  Table rows;  ///< sweep.csv: one row a run in the order of the plan: values, status, state_hash, every observable
  /// means.csv: averages over runs that differ in run.seed alone; errors from their scatter or, where that is larger,
  /// from the errors of the runs.
  Table means;
  std::size_t failures = 0;           ///< runs that failed or could not be set up
  std::size_t interruptions = 0;      ///< runs stopped early or never begun
  std::vector<std::string> messages;  ///< why, one for each failure
  std::vector<std::string> notes;     ///< on settings that have no effect in any run, and on runs that means leave out
};

/// Runs a plan on all cores, the longest runs first, and writes sweep.csv and means.csv; draw_results() draws them.
///
/// In a directory that holds a sweep already, runs that are finished are kept and those that were interrupted resume:
/// after values have been added to the lists, only the new runs are made. A shard writes no tables; collect_sweep()
/// does. The results do not depend on the number of threads, of shards or of interruptions. A run that fails is
/// recorded with its message and the rest continue.
/// Errors: Error where not one run can be set up, where the directory cannot be used, is in use, or holds one of the
/// runs with other settings, before anything is written; RunFailure where results cannot be written.
SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings);

/// Makes one sweep of the directories its shards were run in, or of the one they shared: copies the runs into `into`
/// where they are not there, the one that came farthest of each, and writes plan.json, sweep.csv and means.csv.
/// Errors: Error for a directory without a sweep, for sweeps of different settings, where the directory is in use, and
/// where a file that Gridlock has not written is in the way and `overwrites` does not say that it may be replaced.
SweepResult collect_sweep(std::vector<std::filesystem::path> const& directories, std::filesystem::path const& into,
                          bool overwrites = false);

}  // namespace gridlock
