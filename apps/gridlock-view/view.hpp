#pragma once

#include "gridlock/verbs.hpp"

namespace gridlock::view {

/// Adds the command `view` to a command line. It serves a run, a sweep or a file until it is stopped.
void add_view(CLI::App& app, cli::ExitCode& exit_code);

}  // namespace gridlock::view
