#pragma once

namespace gridlock {

/// Carries out a command of Gridlock: run, resume, sweep, check, plot, movie or any other.
///
/// A program with models of its own calls register_model<Model>() for each of them and then this function; its models
/// then run like the models of Gridlock. Link with `gridlock::command_line`. Prints results to standard output, and
/// errors, notes and progress to standard error. Throws nothing. Returns the exit code for main(): 0 for success, 1 for
/// a run that failed or was stopped, 2 for input that cannot be used.
///
/// ```cpp
/// int main(int argc, char** argv) {
///   return gridlock::command_line(argc, argv);
/// }
/// ```
int command_line(int argc, char** argv);

}  // namespace gridlock
