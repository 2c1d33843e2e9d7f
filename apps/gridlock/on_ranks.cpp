#include "on_ranks.hpp"

#include <exception>
#include <limits>

#include "workspace/sweep_crew.hpp"

namespace gridlock::cli {

namespace {

/// Returns the processes that share the run, after all have called meet().
AllProcesses met_processes(CrewOptions const* options) {
  if (options == nullptr) return {};
  options->set_processes_of_run(std::numeric_limits<std::size_t>::max());
  options->crew.meet(options->command_hash, "");
  return options->crew.processes();
}

/// Leaves the crew, so that no other process waits for this one.
void part(CrewOptions const* options) {
  if (options != nullptr) options->crew.part();
}

}  // namespace

ExitCode carry_out(CrewOptions const* options, RunOutput& output,
                   std::function<std::pair<gridlock::RunRecord, std::filesystem::path>(AllProcesses)> const& work) {
  AllProcesses const processes = met_processes(options);
  try {
    auto const [record, directory] = work(processes);
    part(options);
    return processes.is_root() ? output.finish(record, directory) : ExitCode::good;
  } catch (std::exception const& error) {
    processes.require_failure_of_all(error.what());
    part(options);
    throw;
  }
}

}  // namespace gridlock::cli
