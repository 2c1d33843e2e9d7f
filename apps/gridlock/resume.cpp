#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "gridlock/run/run_directory.hpp"
#include "run_output.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct ResumeOptions {
  std::string directory;
  std::optional<std::uint64_t> threads;
  RunOutput run_output;
};

ExitCode resume(ResumeOptions& options) {
  gridlock::RunHooks hooks = options.run_output.hooks();
  hooks.threads = options.threads;
  return options.run_output.finish(gridlock::resume_in(options.directory, hooks), options.directory);
}

}  // namespace

void add_resume(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb =
      app.add_subcommand("resume", "Go on with a run that was interrupted or killed, to the same bits");
  auto const options = std::make_shared<ResumeOptions>();
  verb->add_option("DIR", options->directory, "Directory of the run")->required();
  verb->add_option("-j,--threads", options->threads, "Threads of the engine tiled; left out: as configured");
  options->run_output.add_to(*verb);
  verb->callback([options, &exit_code] { exit_code = resume(*options); });
}

}  // namespace gridlock::cli
