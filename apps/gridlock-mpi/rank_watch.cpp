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

/// What a launcher says of a process, by the first of these names that it knows; −1 where it says nothing.
long number_of_launcher(std::initializer_list<char const*> names) {
  for (char const* const name : names) {
    if (char const* const text = std::getenv(name)) return std::strtol(text, nullptr, 10);
  }
  return -1;
}
/// Of Open MPI, of launchers for others (MPICH and those like it), and of Slurm.
long ranks_of_launcher() { return number_of_launcher({"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}); }
long rank_of_launcher() { return number_of_launcher({"OMPI_COMM_WORLD_RANK", "PMI_RANK", "SLURM_PROCID"}); }

constexpr std::array to_hand_on{SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2};

/// Stays with its parent. Where that has ended already, so does this process.
void end_with(pid_t parent) {
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  if (getppid() != parent) _exit(EXIT_FAILURE);
}

/// In lists of processes, where both have the same command line.
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

/// Waits for the end of the rank.
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
    // It may have been stopped or continued.
    if (waitpid(rank, &status, WNOHANG) != rank) continue;
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    // Launchers end the ranks that are left when one has failed.
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
  // Whoever has started this process may have had it ignored.
  std::signal(SIGCHLD, SIG_DFL);
  // Held until somebody waits for them: none that comes meanwhile is lost.
  sigprocmask(SIG_BLOCK, &signals, &before);
  pid_t const parent = getpid();
  pid_t const rank = fork();
  if (rank > 0) {
    call_this_process("watch-rank");
    return exit_code_of(rank, signals);
  }
  // Without a second process, this one is the rank.
  if (rank == 0) end_with(parent);
  sigprocmask(SIG_SETMASK, &before, nullptr);
  return std::nullopt;
}

void say_last_words(int file, std::string const& what) {
  dprintf(file, "error: %s\n  hint: all ranks end; %s resume continues a run, the same command a sweep\n", what.c_str(),
          cli::program_name().c_str());
}

}  // namespace gridlock::mpi
