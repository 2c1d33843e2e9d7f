#pragma once

namespace gridlock {

/// Carries out a command that the ranks of MPI share: run, resume or sweep.
///
/// A program with models of its own calls register_model<Model>() for each of them and then this function, as it calls
/// command_line() in a program for one process. If that program is NAME, call this one NAME-mpi: hints name the program
/// NAME for all other commands. Link with `gridlock::mpi_command_line`, which is installed if Gridlock was built with
/// MPI. The program is started by `mpirun` or `srun`. Begins and ends MPI; the program must not do so itself. Rank 0
/// prints what command_line() prints. Throws nothing. Returns the exit code for main(): 0 for success, 1 for a run that
/// failed or was stopped, 2 for input that cannot be used; a rank that fails in the middle of a run ends all ranks.
///
/// ```cpp
/// int main(int argc, char** argv) {
///   return gridlock::mpi_command_line(argc, argv);
/// }
/// ```
int mpi_command_line(int argc, char** argv);

}  // namespace gridlock
