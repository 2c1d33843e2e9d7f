#pragma once

#include <functional>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

/// Carries out a command of one run: with a crew rank 0 does, and the others help it until it has ended. `work` is
/// given the processes of the run.
/// Errors: those of `work`; RunFailure where another rank cannot take part.
ExitCode carry_out(CrewOptions const* options, std::function<ExitCode(AllProcesses)> const& work);

}  // namespace gridlock::cli
