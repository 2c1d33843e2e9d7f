#pragma once

#include <filesystem>
#include <functional>
#include <utility>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "run_output.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

/// Carries out a command on one run in all processes that share the run. `work` gets the processes and returns the
/// record and directory of the run; the root then prints the result. Errors: those of `work`; RunFailure if another
/// process cannot take part.
ExitCode carry_out(CrewOptions const* options, RunOutput& output,
                   std::function<std::pair<gridlock::RunRecord, std::filesystem::path>(AllProcesses)> const& work);

}  // namespace gridlock::cli
