#pragma once

/// \file
/// Replays a run and compares the hashes and frames that it has recorded.
///
/// ```cpp
/// Verification const found = verify_run("results/first", {.windows = 10, .seed = 7});
/// std::string const sentence = to_text(found);
/// bool const is_proved = found.difference.empty();
/// ```

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridlock {

/// The options of verify_run().
struct VerifyOptions {
  std::uint64_t windows = 0;                       ///< number of windows to replay, chosen at random; 0: the whole run
  std::uint64_t seed = 1;                          ///< of the choice
  std::optional<std::uint64_t> window_steps = {};  ///< at least; empty: each window ends at the next recorded hash
  std::optional<std::uint64_t> threads = {};       ///< in place of engine.threads
  std::function<void(double fraction)> on_progress = {};
};

/// The result of verify_run(): the parts of a run that were replayed, and the first difference.
struct Verification {
  std::filesystem::path directory;
  std::string difference;            ///< where replay and record differ first; empty if they agree
  bool is_finished = false;          ///< whether the run has reached its end
  std::uint64_t windows = 0;         ///< windows that were replayed; 0: the whole run, as far as it is recorded
  std::uint64_t first_step = 0;      ///< of the run
  std::uint64_t last_step = 0;       ///< of the run, as far as it is recorded
  std::uint64_t steps = 0;           ///< steps that were replayed
  std::size_t hashes = 0;            ///< recorded hashes that agree
  std::size_t frames = 0;            ///< frames of trajectory.h5 that agree, bit for bit
  std::size_t states = 0;            ///< kept states that agree
  std::size_t results = 0;           ///< files of results that agree; a whole run has them at its end
  std::string version;               ///< of this program
  std::string target;                ///< instructions of the replay
  std::string recorded_version;      ///< of the run; empty if it is not finished
  std::string recorded_target = {};  ///< instructions of the run
};

/// Replays the run in a directory, or windows of it, and compares each recorded state hash, frame and kept state that
/// it passes, bit for bit; of a whole run also its results: summary.json, final.xyz and all tables that are there.
///
/// A run that is not finished is replayed up to its last recorded hash. A window begins at one of the states that
/// checkpoint.keep_states has kept, whose hash is compared first.
/// Errors: Error for a directory without a run, a run that a process works on, one that has recorded no hashes or, for
/// windows, kept no states, and one whose settings or start file were changed since, by name.
/// Cost: that of the steps that are replayed.
Verification verify_run(std::filesystem::path const& directory, VerifyOptions const& options = {});

/// Returns the result as a sentence: which steps agree, with which instructions and version, or where they differ.
std::string to_text(Verification const& found);

/// The result of verify_all().
struct VerifiedRuns {
  std::vector<Verification> runs;  ///< those that could be replayed; of a study one entry for all
  std::size_t verified = 0;        ///< runs
  std::size_t different = 0;
  std::size_t refused = 0;  ///< runs that cannot be verified, or are missing from their sweep
};

/// Verifies a run; all runs below a directory, as of a sweep; or a study, whose table runs.csv has the settings of each
/// run in JSON and its last state hash, in the columns `settings` and `state_hash`.
///
/// `on_line` is called with a sentence on each run, and for several with one on all. Windows are parts of each run; of
/// a study they are whole runs, chosen at random. Errors: those of verify_run() for one run; for several Error if there
/// is no such directory, or none of a run in it. Cost: that of the runs.
VerifiedRuns verify_all(std::filesystem::path const& directory, VerifyOptions const& options,
                        std::function<void(std::string const&)> const& on_line);

}  // namespace gridlock
