#pragma once

#include <optional>
#include <string>

namespace gridlock::mpi {

/// Goes on in a child process, which becomes the rank, where a launcher such as mpirun has started several. The process
/// that the launcher knows stays behind and watches it, so that the launcher gets an exit code that says what happened,
/// also of a rank that is killed.
///
/// Returns nothing in the rank; in the watching process, once the rank has ended, the exit code: that of the rank, or 1
/// with a message where a signal has ended it. Signals that ask to stop go on to the rank. A rank does not outlive the
/// process that watches it (Linux). To be called before there are threads, and before MPI begins.
[[nodiscard]] std::optional<int> watch_rank();

/// Writes why a rank ends all, and what continues a run or a sweep, to an open file.
void say_last_words(int file, std::string const& what);

}  // namespace gridlock::mpi
