#include "gridlock/mpi_command_line.hpp"

#include <mpi.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "gridlock/terminal.hpp"
#include "gridlock/verbs.hpp"
#include "mpi_crew.hpp"
#include "rank_watch.hpp"

namespace {

/// Says what ends a rank in the middle of a run, also where it is silent otherwise.
class LastWords {
 public:
  LastWords() : standard_error_(dup(STDERR_FILENO)) {}

  void operator()(std::string const& why) const {
    int rank = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    gridlock::mpi::say_last_words(standard_error_, "rank " + std::to_string(rank) + ": " + why);
  }

 private:
  int standard_error_;
};

/// Has columns go back to the system where they are freed. Agents are copied between ranks again and again; an
/// allocator that keeps what is freed for other sizes holds up to twice of what they need.
void return_large_memory() {
#if defined(__GLIBC__)
  constexpr int bytes = 1 << 21;
  static_cast<void>(mallopt(M_MMAP_THRESHOLD, bytes));
#endif
}

/// Rank 0 speaks for all.
void be_silent() {
  for (std::FILE* const stream : {stdout, stderr}) {
    if (std::freopen("/dev/null", "w", stream) == nullptr) std::fclose(stream);
  }
}

}  // namespace

int gridlock::mpi_command_line(int argc, char** argv) {
  // A rank that a signal ends while MPI begins would leave mpirun waiting.
  gridlock::cli::StopSignals::keep_until_begun();
  gridlock::cli::set_program_name_of(argc, argv);
  if (std::optional<int> const exit_code = gridlock::mpi::watch_rank()) return *exit_code;
  return_large_memory();
  // The thread that began talks to other ranks; of a sweep whose runs have several ranks those that make runs, too.
  int granted = 0;
  if (MPI_Init_thread(&argc, &argv, MPI_THREAD_MULTIPLE, &granted) != MPI_SUCCESS) return EXIT_FAILURE;
  int exit_code = EXIT_FAILURE;
  {
    using gridlock::cli::StopSignals;
    LastWords const last_words;
    gridlock::mpi::MpiCrew crew(
        {.is_stop_asked = StopSignals::is_stop_asked, .ask_to_stop = StopSignals::ask_to_stop, .complain = last_words});
    if (!crew.leads()) be_silent();
    std::string failure;
    exit_code = gridlock::cli::command_line_of_crew(
        argc, argv,
        {.crew = crew,
         .set_runs_at_a_time = [&](std::size_t count) { crew.set_runs_at_a_time(count); },
         .set_processes_of_run = [&](std::size_t count) { crew.set_processes_of_run(count); },
         .has_threads_that_send = granted == MPI_THREAD_MULTIPLE},
        failure);
    // Others wait for a rank that has failed: to begin, or for its part of the work.
    if (!failure.empty() && !crew.has_met()) crew.meet(0, failure);
    if (crew.is_working()) MPI_Abort(MPI_COMM_WORLD, exit_code);
    // mpirun ends with the first code that is not 0, which is to be that of the rank that speaks.
    if (!crew.leads()) exit_code = EXIT_SUCCESS;
  }
  MPI_Finalize();
  return exit_code;
}
