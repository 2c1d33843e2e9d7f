#pragma once

#include <filesystem>
#include <functional>
#include <utility>

#include "gridlock/parallel/detail/all_processes.hpp"
#include "run_output.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

/// Carries out a command of one run in all processes that share it: `work` is given them and returns the record of the
/// run and its directory; the root then says how it has ended.
/// Errors: those of `work`; RunFailure where another process cannot take part.
ExitCode carry_out(CrewOptions const* options, RunOutput& output,
                   std::function<std::pair<gridlock::RunRecord, std::filesystem::path>(AllProcesses)> const& work);

}  // namespace gridlock::cli
