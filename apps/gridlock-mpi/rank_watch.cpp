#include "rank_watch.hpp"

#include <fmt/format.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <string>

#ifdef __linux__
#include <sys/prctl.h>
#endif

#include "gridlock/verbs.hpp"

namespace gridlock::mpi {

namespace {

/// Returns the number in the first environment variable of the launcher that exists; −1 if there is none.
long number_of_launcher(std::initializer_list<char const*> names) {
  for (char const* const name : names) {
    if (char const* const text = std::getenv(name)) return std::strtol(text, nullptr, 10);
  }
  return -1;
}
/// The variables of Open MPI, of PMI launchers (MPICH and relatives), and of Slurm.
long ranks_of_launcher() { return number_of_launcher({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}); }
long rank_of_launcher() { return number_of_launcher({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"}); }

constexpr std::array to_hand_on{SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2};

/// Ends this process when its parent ends, also if that has ended already.
void end_with(pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != parent) _exit(EXIT_FAILURE);
}

/// Sets the name of this process in lists, where the rank and its watcher have the same command line.
void call_this_process([[maybe_unused]] char const* name) {
#ifdef __linux__
  prctl(PR_SET_NAME, name);
#endif
}

void tell_of_end_by(int signal) {
  char const* const reason = signal == SIGKILL ? "; its machine may have had no memory left" : "";
  say_last_words(STDERR_FILENO, fmt::format("rank {} was ended by signal {} ({}){}", rank_of_launcher(), signal,
                                            strsignal(signal), reason));
}

/// Waits for the end of the rank, and passes signals on to it. Returns the exit code.
int exit_code_of(pid_t rank, sigset_t const& signals) {
  sigset_t handed_on;
  sigemptyset(&handed_on);
  while (true) {
    int signal = 0;
    sigwait(&signals, &signal);
    if (signal != SIGCHLD) {
      sigaddset(&handed_on, signal);
      kill(rank, signal);
      continue;
    }
    int status = 0;
    // SIGCHLD also arrives when the rank is stopped or continued.
    if (waitpid(rank, &status, WNOHANG) != rank) continue;
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    // No message is needed for a signal that was passed on: launchers end all ranks after one has failed.
    if (sigismember(&handed_on, WTERMSIG(status)) == 0) tell_of_end_by(WTERMSIG(status));
    return EXIT_FAILURE;
  }
}

}  // namespace

std::optional<int> watch_rank() {
  if (ranks_of_launcher() <= 1) return std::nullopt;
  sigset_t signals, before;
  sigemptyset(&signals);
  sigaddset(&signals, SIGCHLD);
  for (int const signal : to_hand_on) sigaddset(&signals, signal);
  // The parent process may have set SIGCHLD to be ignored, which would hide the end of the rank.
  std::signal(SIGCHLD, SIG_DFL);
  // Signals are blocked until sigwait(), so that none is lost.
  sigprocmask(SIG_BLOCK, &signals, &before);
  pid_t const parent = getpid();
  pid_t const rank = fork();
  if (rank > 0) {
    call_this_process("watch-rank");
    return exit_code_of(rank, signals);
  }
  // If fork() fails, this process becomes the rank without a watcher.
  if (rank == 0) end_with(parent);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  return std::nullopt;
}

void say_last_words(int file, std::string const& what) {
  dprintf(file, "error: %s\n  hint: all ranks end; %s resume continues a run, the same command a sweep\n", what.c_str(),
          cli::program_name().c_str());
}

}  // namespace gridlock::mpi
