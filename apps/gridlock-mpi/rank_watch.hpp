#pragma once

#include <optional>
#include <string>

namespace gridlock::mpi {

/// Forks if a launcher such as mpirun has started several ranks: the child becomes the rank, and this process watches
/// it. The launcher thus gets a meaningful exit code even if a rank is killed.
///
/// Returns nothing in the rank. In the watching process it returns the exit code of the rank when that ends, or prints
/// a message and returns 1 if a signal ended it. Signals that request a stop are passed on to the rank. The rank ends
/// with its watcher (Linux). Must be called before threads exist and before MPI_Init.
[[nodiscard]] std::optional<int> watch_rank();

/// Writes to a file descriptor why a rank ends all ranks, and how to continue the run or sweep.
void say_last_words(int file, std::string const& what);

}  // namespace gridlock::mpi
