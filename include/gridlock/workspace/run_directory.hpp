#pragma once

/// \file
/// Runs in a directory of their own: checkpoints, results and resuming.
///
/// ```cpp
/// RunRecord const record = run_in("results/first", set_up(SettingsFile::from_path("scenes/paper.toml")));
/// std::vector<NamedEstimate> const results = read_summary("results/first")->results;
/// ```

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "gridlock/simulation/simulate.hpp"

namespace gridlock {

/// Creates the directory of a run if it is missing, and checks that the run may write into it.
///
/// Without `overwrites` nothing is replaced: neither earlier results nor files of the user with names that the run
/// needs. With `overwrites` both are replaced, and no other file. The start file and the settings file of the run are
/// never replaced.
/// Errors: Error with the key "-o".
void open_run_directory(std::filesystem::path const& directory, Setup const& setup, bool overwrites,
                        std::filesystem::path const& settings_file = {});

/// Whether a lock excludes all other processes, or only those that do not share it.
enum class Sharing { alone, with_others };

/// A lock that keeps other processes from writing into a directory until it is destroyed or the process ends. Errors:
/// Error with the key "-o" if another process holds the lock.
class DirectoryLock {
 public:
  static constexpr char const* file_name = ".lock";

  explicit DirectoryLock(std::filesystem::path const& directory, Sharing sharing = Sharing::alone);
  ~DirectoryLock();
  DirectoryLock(DirectoryLock const&) = delete;
  DirectoryLock& operator=(DirectoryLock const&) = delete;

  /// Returns whether a process holds the lock of the directory. Some file systems show only locks of this machine.
  static bool is_held(std::filesystem::path const& directory);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// The functions and options of a run in a directory.
struct RunHooks {
  OnProgress on_progress;
  std::function<void(Event const&)> on_event;  ///< called for every line of run.log
  std::optional<std::uint64_t> threads;        ///< in place of engine.threads; empty: engine.threads
  AllProcesses processes = {};                 ///< for resume_in() and lengthen_in(): processes that share the run
};

/// Runs a set-up in a directory of its own, which has from the first step on
///
///     config.resolved.toml   gives the same run again, to the bit; with start.xyz for a start from a file
///     checkpoint.gridlock    all data to continue the run, and .previous. the one before, until it is finished; the
///                            last one stays unless checkpoint.keep_last = false, for lengthen_in() to continue from
///     run.log                events of the run with their times
///     trajectory.h5          its frames, if [trajectory] sets any
///
/// and in the end
///
///     summary.json           every result with its error, state hash, version, seed, timing
///     series.csv             one row per sample
///     <distribution>.csv     speed_distribution, pair_correlation …
///     final.xyz              the last state
///
/// A run that is interrupted writes a checkpoint; a run that fails keeps its last checkpoint. A checkpoint that cannot
/// be written is logged, and the run continues. Every file is written completely or not at all; summary.json is the
/// last. Earlier results of Gridlock in the directory are removed first. Errors: Error if another process works in the
/// directory, or if a file that Gridlock has not written has a name that the run needs; RunFailure if results cannot be
/// written.
RunRecord run_in(std::filesystem::path const& directory, Setup setup, RunHooks const& hooks = {});

/// Continues a run that was interrupted, killed or failed from its newest undamaged checkpoint, or from the start if
/// there is no checkpoint. It ends with the same bits as a run without interruption, for any number of threads. Errors:
/// those of run_in(); Error if the directory has no run, if the run is finished, if its checkpoints are of another
/// version or configuration or all damaged, or if trajectory.h5 lacks frames from before the checkpoint.
RunRecord resume_in(std::filesystem::path const& directory, RunHooks const& hooks = {});

/// The length of a run from its start: the run ends when it reaches the first of the given lengths.
struct RunLength {
  std::optional<std::uint64_t> steps;
  std::optional<double> time;
  std::optional<double> collisions_per_disk;
};

/// Continues a run, finished or not, to another length, which replaces all earlier lengths.
///
/// config.resolved.toml gets the new length, and the run ends with the same bits as a new run of this configuration.
/// Averages still leave out the same samples: if observe.equilibration of the new length would leave out another number
/// of samples, it is changed in config.resolved.toml to a share that fits. If the process is killed, resume_in()
/// continues the run to the old or the new length. Errors: those of resume_in(), except that the run may be finished;
/// Error if a finished run kept no checkpoint, and for a length that the run has passed or that is below its earlier
/// length.
RunRecord lengthen_in(std::filesystem::path const& directory, RunLength const& length, RunHooks const& hooks = {});

/// The contents of the file summary.json of a run.
struct RunSummary {
  RunStatus status = RunStatus::interrupted;
  std::string failure;
  std::uint64_t start_hash = 0;
  std::uint64_t state_hash = 0;
  double seconds = 0.0;
  std::vector<NamedEstimate> results;
  std::string version;      ///< of the program
  std::string target = {};  ///< instructions of the processor
};

/// Reads summary.json of a directory; returns nothing if the file is missing.
/// Errors: Error for a file that is damaged.
std::optional<RunSummary> read_summary(std::filesystem::path const& directory);

/// Returns the text of config.resolved.toml for a set-up.
std::string resolved_configuration(Setup const& setup);

}  // namespace gridlock
