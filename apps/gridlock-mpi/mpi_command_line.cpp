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

/// Prints why a rank ends during a run, also on ranks whose standard error is switched off.
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

/// Makes malloc return freed columns to the system. Agents are copied between ranks repeatedly, and a malloc that keeps
/// freed memory of other sizes would hold up to twice the memory in use.
void return_large_memory() {
#if defined(__GLIBC__)
  constexpr int bytes = 1 << 21;
  static_cast<void>(mallopt(M_MMAP_THRESHOLD, bytes));
#endif
}

/// Switches off standard output and error on ranks other than 0.
void be_silent() {
  for (std::FILE* const stream : {stdout, stderr}) {
    if (std::freopen("/dev/null", "w", stream) == nullptr) std::fclose(stream);
  }
}

}  // namespace

int gridlock::mpi_command_line(int argc, char** argv) {
  // A signal must not end a rank during MPI_Init, since mpirun would then wait for ever.
  gridlock::cli::StopSignals::keep_until_begun();
  gridlock::cli::set_program_name_of(argc, argv);
  if (std::optional<int> const exit_code = gridlock::mpi::watch_rank()) return *exit_code;
  return_large_memory();
  // Beside the main thread, threads that carry out runs on several ranks call MPI too.
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
    // Other ranks wait in meet() for a rank that has failed before it.
    if (!failure.empty() && !crew.has_met()) crew.meet(0, failure);
    if (crew.is_working()) MPI_Abort(MPI_COMM_WORLD, exit_code);
    // mpirun returns the first exit code other than 0, so only rank 0, which prints, returns its code.
    if (!crew.leads()) exit_code = EXIT_SUCCESS;
  }
  MPI_Finalize();
  return exit_code;
}
