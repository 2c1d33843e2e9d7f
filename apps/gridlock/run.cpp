#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "gridlock/run/pictures.hpp"
#include "gridlock/run/run_directory.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace {

struct RunOptions {
  ConfigurationOptions configuration;
  OutputOptions output;
  bool draws_nothing = false;
  bool is_quiet = false;
};

/// The observables a first look asks for; summary.json has all of them.
constexpr char const* headlines[] = {"mean_displacement", "mean_squared_displacement",
                                     "kinetic_energy",    "compressibility_factor",
                                     "wall_pressure",     "collision_rate",
                                     "blocked_share"};

void print_result(gridlock::RunResult const& result) {
  fmt::print("{} {} steps of {} disks in {} ({}disk-steps/s)\n", gridlock::to_text(result.ending), result.steps,
             result.state.disks.size(), duration_text(result.seconds), count_text(result.agent_steps_per_second()));
  for (char const* name : headlines) {
    auto const found = std::ranges::find(result.results, name, &gridlock::NamedEstimate::name);
    if (found == result.results.end()) continue;
    auto const& [value, error] = found->estimate;
    fmt::print("  {:<26} {:.6g}{}{}\n", name, value, error ? fmt::format(" ± {:.2g}", *error) : "",
               found->unit.empty() ? "" : "  " + found->unit);
  }
  fmt::print("  {:<26} {:016x}\n", "state_hash", gridlock::hash(result.state));
}

void draw(std::filesystem::path const& directory) {
  for (std::string const& note : gridlock::draw_results(directory).notes) fmt::print(stderr, "note: {}\n", note);
}

ExitCode run(RunOptions const& options) {
  gridlock::Setup const setup = gridlock::set_up(options.configuration.read());
  auto const directory =
      options.output.directory_for(std::filesystem::path(options.configuration.file).stem().string());
  gridlock::open_run_directory(directory, options.output.overwrites);

  StopSignals const signals;
  gridlock::RunResult result;
  {
    ProgressLine line;
    result = gridlock::simulate(setup, [&](gridlock::Progress const& progress) {
      if (!options.is_quiet) {
        line.show(progress.fraction, progress.seconds,
                  fmt::format("step {}  {}disk-steps/s", progress.steps, count_text(progress.agent_steps_per_second)));
      }
      return !StopSignals::is_stop_asked();
    });
  }
  gridlock::write_run(setup, result, directory);
  if (!options.draws_nothing) draw(directory);
  if (!options.is_quiet) {
    print_result(result);
    fmt::print("results in {}\n", directory.string());
  }
  if (result.ending == gridlock::Ending::finished) return ExitCode::good;
  if (result.ending == gridlock::Ending::failed) fmt::print(stderr, "error: {}\n", result.failure);
  fmt::print(stderr, "{}: the run ended after {} steps; what there is stands in {}\n", gridlock::to_text(result.ending),
             result.steps, directory.string());
  return ExitCode::run_failed;
}

}  // namespace

void add_run(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("run", "Run one simulation");
  auto const options = std::make_shared<RunOptions>();
  options->configuration.add_to(*verb);
  options->output.add_to(*verb, "results/<name of FILE>");
  verb->add_flag("--no-pictures", options->draws_nothing, "Write data only");
  verb->add_flag("-q,--quiet", options->is_quiet, "Print errors only");
  verb->callback([options, &exit_code] { exit_code = run(*options); });
}
