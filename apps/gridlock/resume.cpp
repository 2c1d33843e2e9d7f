#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "gridlock/workspace/run_directory.hpp"
#include "on_ranks.hpp"
#include "run_output.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct ResumeOptions {
  std::string directory;
  std::optional<std::uint64_t> threads;
  gridlock::RunLength length;
  RunOutput run_output;
};

gridlock::RunRecord resume(ResumeOptions& options, AllProcesses processes) {
  gridlock::RunHooks hooks = options.run_output.hooks();
  hooks.threads = options.threads;
  hooks.processes = processes;
  gridlock::RunLength const& length = options.length;
  bool const lengthens = length.steps || length.time || length.collisions_per_disk;
  return lengthens ? gridlock::lengthen_in(options.directory, length, hooks)
                   : gridlock::resume_in(options.directory, hooks);
}

}  // namespace

void add_resume(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew) {
  CLI::App* const verb = app.add_subcommand(
      "resume", "Continue a run that was interrupted or killed, or make a run longer, with the same bits");
  auto const options = std::make_shared<ResumeOptions>();
  verb->add_option("DIR", options->directory, "Directory of the run")->required();
  verb->add_option(
          "-j,--threads", options->threads,
          crew == nullptr
              ? "Threads of exact, tiled, soft and models; 0: one for each core; left out: as configured"
              : "Threads of each rank; 0: the cores divided among the ranks of a machine; left out: as configured")
      ->check(whole_number(0, 1024));
  verb->add_option("--steps", options->length.steps, "New length of the run in steps, counted from its start")
      ->type_name("N")
      ->check(whole_number(0));
  verb->add_option("--time", options->length.time, "New length in physical time")->type_name("T");
  verb->add_option("--collisions-per-disk", options->length.collisions_per_disk,
                   "New length in collisions of each disk")
      ->type_name("C");
  options->run_output.add_to(*verb);
  verb->callback([options, &exit_code, crew] {
    exit_code = carry_out(crew, options->run_output, [&](AllProcesses processes) {
      return std::pair(resume(*options, processes), std::filesystem::path(options->directory));
    });
  });
}

}  // namespace gridlock::cli
