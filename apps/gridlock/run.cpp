#include <fmt/format.h>

#include <cstdio>
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

struct RunOptions {
  ConfigurationOptions configuration;
  OutputOptions output;
  RunOutput run_output;
  std::optional<unsigned> threads;
};

std::pair<gridlock::RunRecord, std::filesystem::path> run(RunOptions& options, AllProcesses processes) {
  gridlock::SettingsFile settings;
  processes.on_root([&] {
    settings = options.configuration.read();
    if (!options.threads) return;
    std::string const number = std::to_string(*options.threads);
    settings.set("engine.threads", number, {.file = "--threads", .source_line = number});
  });
  gridlock::Setup setup = gridlock::set_up(
      settings, {.on_slow_start =
                     [](double seconds) {
                       fmt::print(
                           stderr,
                           "note: the random start takes about {:.0f} s; Ctrl-C stops it, and nothing is written yet\n",
                           seconds);
                       return true;
                     },
                 .processes = processes});
  auto const directory =
      options.output.directory_for(std::filesystem::path(options.configuration.file).stem().string());
  processes.on_root(
      [&] { gridlock::open_run_directory(directory, setup, options.output.overwrites, options.configuration.file); });
  gridlock::RunHooks const hooks = options.run_output.hooks();
  return {gridlock::run_in(directory, std::move(setup), hooks), directory};
}

}  // namespace

void add_run(CLI::App& app, ExitCode& exit_code, CrewOptions const* crew) {
  CLI::App* const verb = app.add_subcommand(
      "run", crew == nullptr ? "Run one simulation"
                             : "Run one simulation, of the engine tiled or a synchronous or tiled model, on all ranks");
  auto const options = std::make_shared<RunOptions>();
  options->configuration.add_to(*verb);
  options->output.add_to(*verb, "results/<name of FILE>");
  verb->add_option("-j,--threads", options->threads,
                   crew == nullptr
                       ? "Threads of exact, tiled, soft and models, as engine.threads; 0: one for each core"
                       : "Threads of each rank, as engine.threads; 0: the cores divided among the ranks of a machine")
      ->check(whole_number(0, 1024));
  options->run_output.add_to(*verb);
  verb->callback([options, &exit_code, crew] {
    exit_code = carry_out(crew, options->run_output, [&](AllProcesses processes) { return run(*options, processes); });
  });
}

}  // namespace gridlock::cli
