#pragma once

/// \file
/// Runs that write a directory: checkpoints, results, resuming.
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

/// Makes sure a run may write into the directory, which is created where it is missing.
///
/// Without `overwrites` nothing is replaced: neither results that are there already nor files of the user under the
/// names that the run needs. With it both are, and no other file. The start file and the settings file are what the run
/// is made from and stay in any case.
/// Errors: Error under the key "-o".
void open_run_directory(std::filesystem::path const& directory, Setup const& setup, bool overwrites,
                        std::filesystem::path const& settings_file = {});

/// Whether a directory is kept from all other processes, or shared with those that share it too.
enum class Sharing { alone, with_others };

/// Keeps other processes from writing into a directory, for as long as it lives.
/// Errors: Error under the key "-o" where another process holds it. A lock dies with its process, however that ends.
class DirectoryLock {
 public:
  static constexpr char const* file_name = ".lock";

  explicit DirectoryLock(std::filesystem::path const& directory, Sharing sharing = Sharing::alone);
  ~DirectoryLock();
  DirectoryLock(DirectoryLock const&) = delete;
  DirectoryLock& operator=(DirectoryLock const&) = delete;

  /// Whether a process is at work in the directory, as far as the file system tells: one that keeps locks of each
  /// machine apart knows of this one alone.
  static bool is_held(std::filesystem::path const& directory);

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

/// Who wants to know what of a run in a directory.
struct RunHooks {
  OnProgress on_progress;
  std::function<void(Event const&)> on_event;  ///< called for every line of run.log
  std::optional<std::uint64_t> threads;        ///< in place of engine.threads; left out: as configured
  AllProcesses processes = {};                 ///< of resume_in() and lengthen_in(): those that share the run
};

/// Runs a set-up in a directory of its own, which holds from the first step on
///
///     config.resolved.toml   the run again, to the bit; start.xyz too where it began from a file
///     checkpoint.gridlock    everything the rest of the run depends on, and .previous. before it until it is finished; the
///                            last one stays unless checkpoint.keep_last = false, for lengthen_in() to continue from
///     run.log                what happened when
///     trajectory.h5          its frames, where [trajectory] asks for some
///
/// and in the end
///
///     summary.json           every final observable with its error, state hash, version, seed, timing
///     series.csv             one row per sample
///     <distribution>.csv     speed_distribution, pair_correlation …
///     final.xyz              the last state
///
/// A run that is interrupted saves itself; one that fails leaves the last checkpoint before. A checkpoint that cannot
/// be written is noted, and the run continues. Every file is written whole or not at all; summary.json comes last.
/// Results that Gridlock has written there before are removed first.
/// Errors: Error where another process works in the directory, and where a file that Gridlock has not written has a
/// name that the run needs; RunFailure where results cannot be written.
RunRecord run_in(std::filesystem::path const& directory, Setup setup, RunHooks const& hooks = {});

/// Continues a run that was interrupted, killed or failed: from its newest checkpoint that is whole, or from the start
/// where there is none. It ends with the same bits as a run that was never interrupted, whatever the number of threads.
/// Errors: those of run_in(); Error where the directory holds no run, where the run is finished, where its checkpoints
/// are of another version or another configuration, or all damaged, or where trajectory.h5 lacks frames from before the
/// checkpoint.
RunRecord resume_in(std::filesystem::path const& directory, RunHooks const& hooks = {});

/// The length of a run from its start: the run ends at whichever of those given comes first.
struct RunLength {
  std::optional<std::uint64_t> steps;
  std::optional<double> time;
  std::optional<double> collisions_per_disk;
};

/// Continues a run, finished or not, to another length, which takes the place of all lengths it had.
///
/// It ends with the same bits as a run of the configuration that config.resolved.toml holds from then on: the old one
/// with the new length. State, series and frames are those of a run that long. Averages continue to leave out the
/// samples that they have left out so far: where the share observe.equilibration of the new length would be another
/// number of them, observe.equilibration in config.resolved.toml becomes the share that fits. A lengthening that is
/// killed at any time is continued by resume_in(), to the old length or the new one.
/// Errors: those of resume_in(), except that the run may be finished; Error where a finished run kept no checkpoint,
/// and for a length that the run has passed or that is below the one it has.
RunRecord lengthen_in(std::filesystem::path const& directory, RunLength const& length, RunHooks const& hooks = {});

/// The contents of summary.json of a run.
struct RunSummary {
  RunStatus status = RunStatus::interrupted;
  std::string failure;
  std::uint64_t start_hash = 0;
  std::uint64_t state_hash = 0;
  double seconds = 0.0;
  std::vector<NamedEstimate> results;
};

/// Reads summary.json of a directory; nothing where there is none.
/// Errors: Error for a file that is damaged.
std::optional<RunSummary> read_summary(std::filesystem::path const& directory);

/// The configuration of a set-up as its directory keeps it.
std::string resolved_configuration(Setup const& setup);

}  // namespace gridlock
