#include "gridlock/run/sweep.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "gridlock/run/pictures.hpp"
#include "gridlock/run/run_directory.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace {

struct SweepOptions {
  ConfigurationOptions configuration;
  OutputOptions output;
  unsigned threads = 0;
  bool is_quiet = false;
};

ExitCode sweep(SweepOptions const& options) {
  gridlock::SweepPlan const plan = gridlock::plan_sweep(options.configuration.read());
  auto const directory =
      options.output.directory_for(std::filesystem::path(options.configuration.file).stem().string());

  StopSignals const signals;
  gridlock::SweepResult result;
  {
    ProgressLine line;
    result = gridlock::run_sweep(plan, {.directory = directory,
                                        .overwrites = options.output.overwrites,
                                        .threads = options.threads,
                                        .on_progress = [&](gridlock::SweepProgress const& progress) {
                                          if (!options.is_quiet) {
                                            line.show(progress.fraction, progress.seconds,
                                                      fmt::format("{} of {} runs", progress.finished, progress.all));
                                          }
                                          return !StopSignals::is_stop_asked();
                                        }});
  }
  for (std::string const& note : gridlock::draw_results(directory).notes) fmt::print(stderr, "note: {}\n", note);
  for (std::string const& message : result.messages) fmt::print(stderr, "error: {}\n", message);
  std::size_t const good = plan.runs.size() - result.failures - result.interruptions;
  if (!options.is_quiet) {
    fmt::print("{} of {} runs finished; sweep.csv, means.csv and runs/ in {}\n", good, plan.runs.size(),
               directory.string());
  }
  if (good == plan.runs.size()) return ExitCode::good;
  fmt::print(stderr, "{} runs failed, {} were stopped early; what there is stands in {}\n", result.failures,
             result.interruptions, directory.string());
  return ExitCode::run_failed;
}

}  // namespace

void add_sweep(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("sweep", "Run every combination of the values listed under [sweep]");
  auto const options = std::make_shared<SweepOptions>();
  options->configuration.add_to(*verb);
  options->output.add_to(*verb, "results/<name of FILE>");
  verb->add_option("-j,--threads", options->threads, "Runs at a time; left out: one for each core")
      ->check(CLI::Range(1U, 4096U));
  verb->add_flag("-q,--quiet", options->is_quiet, "Print errors only");
  verb->callback([options, &exit_code] { exit_code = sweep(*options); });
}
