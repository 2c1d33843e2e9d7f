#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/types.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "cli/program.hpp"

namespace gridlock::test {

template <class Value>
std::vector<Value> operator+(std::vector<Value> words, std::vector<Value> const& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// mpirun, whoever starts it, on more ranks than cores.
inline Process mpirun(Workplace const& workplace, std::vector<std::string> const& arguments) {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  // With the address sanitizer: what Open MPI itself leaks at its end.
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  // Two that start at once would both make the same folder, and one of them would fail.
  fs::path const folder = workplace.path() / "mpi";
  fs::create_directory(folder);
  setenv("OMPI_MCA_orte_tmpdir_base", folder.c_str(), 1);
  return {GRIDLOCK_MPIEXEC, std::vector<std::string>{"--oversubscribe"} + arguments, workplace.path()};
}

inline Process start(Workplace const& workplace, int ranks, std::vector<std::string> const& arguments,
                     char const* program = GRIDLOCK_MPI_PROGRAM) {
  return mpirun(workplace, std::vector<std::string>{"-n", std::to_string(ranks), program} + arguments);
}

inline Outcome on_ranks(Workplace const& workplace, int ranks, std::vector<std::string> const& arguments,
                        char const* program = GRIDLOCK_MPI_PROGRAM) {
  return start(workplace, ranks, arguments, program).wait();
}

/// How a run or sweep ends after a signal to mpirun. After SIGTERM mpirun kills its ranks within a second, whether they
/// have saved themselves or not; what they have of before is good then.
inline void expect_stopped_by(int signal, Outcome const& outcome) {
  if (signal == SIGTERM) {
    EXPECT_NE(outcome.exit_code, 0);
  } else {
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  }
}

/// How mpirun ends where a rank has been killed.
inline void expect_ended_by_kill(Outcome const& outcome, std::size_t rank) {
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  std::string const message = "error: rank " + std::to_string(rank) + " was ended by signal 9 (Killed)";
  EXPECT_NE(outcome.err.find(message), std::string::npos) << outcome.err;
}

inline std::size_t occurrences(std::string const& text, std::string const& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// Refuses each command on three ranks for its reason, says so once, and leaves nothing in "out".
inline void expect_refused(Workplace const& workplace,
                           std::vector<std::pair<std::vector<std::string>, std::string>> const& refused,
                           char const* program = GRIDLOCK_MPI_PROGRAM) {
  for (auto const& [arguments, reason] : refused) {
    Outcome const outcome = on_ranks(workplace, 3, arguments, program);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_EQ(occurrences(outcome.err, "error: "), 1U) << outcome.err;
    EXPECT_NE(outcome.err.find(reason), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(workplace / "out"));
  }
}

/// Light disks that heavy ones drive: with long time steps they become too fast for their sub-steps. More settings of
/// [engine] may follow.
inline constexpr char const* light_among_heavy =
    "[disks]\ncount = 300\npacking_fraction = 0.3\nstart = \"random\"\n"
    "species = [{fraction = 0.5, mass = 1000.0}, {fraction = 0.5}]\n"
    "[engine]\nkind = \"tiled\"\nsubsteps = 2\n";

/// The processes that another one has started.
inline std::vector<pid_t> children_of(pid_t process) {
  std::string const id = std::to_string(process);
  std::istringstream names(text_of("/proc/" + id + "/task/" + id + "/children"));
  std::vector<pid_t> children;
  for (pid_t child = 0; names >> child;) children.push_back(child);
  return children;
}

/// When the newest checkpoint in a directory and those in it was written.
inline fs::file_time_type time_of_newest_checkpoint(fs::path const& directory) {
  fs::file_time_type newest = fs::file_time_type::min();
  std::error_code error;
  for (fs::recursive_directory_iterator file(directory, error), end; !error && file != end; file.increment(error)) {
    // Files come and go meanwhile.
    std::error_code gone;
    fs::file_time_type const time = fs::last_write_time(file->path(), gone);
    if (!gone && file->path().extension() == ".gridlock") newest = std::max(newest, time);
  }
  return newest;
}

/// Several ranks in the middle of a run or sweep in the directory "out".
struct RanksAtWork {
  Process process;
  std::vector<pid_t> watchers;  ///< that mpirun has started
  std::vector<pid_t> ranks;     ///< that these have started

  /// Sends a signal to one of them after some time.
  void signal(std::size_t rank, int number, std::chrono::milliseconds after) const {
    std::this_thread::sleep_for(after);
    kill(ranks.at(rank), number);
  }
};

/// Starts them, and waits until they have written a checkpoint: how long a machine takes to start them is not known,
/// and only ranks that work heed signals.
inline RanksAtWork start_and_wait_for_checkpoint(Workplace const& workplace, std::size_t count,
                                                 std::vector<std::string> const& arguments) {
  fs::path const directory = workplace / "out";
  fs::file_time_type const before = time_of_newest_checkpoint(directory);
  Process const process = start(workplace, static_cast<int>(count), arguments);
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(120);
  while (time_of_newest_checkpoint(directory) <= before && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GT(time_of_newest_checkpoint(directory), before) << "no checkpoint has come";
  RanksAtWork at_work{.process = process, .watchers = children_of(process.id()), .ranks = {}};
  for (pid_t const watcher : at_work.watchers) at_work.ranks = at_work.ranks + children_of(watcher);
  EXPECT_EQ(at_work.ranks.size(), count);
  return at_work;
}

}  // namespace gridlock::test
