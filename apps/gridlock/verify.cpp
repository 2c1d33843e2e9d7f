#include "gridlock/workspace/verify.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/playground_link.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct VerifyCommandOptions {
  std::string directory;
  gridlock::VerifyOptions verify;
  bool links = false;
};

/// Prints the address at which the page makes the run again, which needs no program.
void print_link(std::filesystem::path const& run) {
  std::error_code ignored;
  if (std::filesystem::exists(run / "start.xyz", ignored)) {
    throw gridlock::Error(
        {.what = fmt::format("the run in {} starts from a file, which a link cannot hold", run.string()),
         .hint = "leave out --link",
         .key = "--link"});
  }
  fmt::print("the page shows the same state hash at the end: {}\n",
             gridlock::playground_link(gridlock::read_file(run / "config.resolved.toml")));
}

ExitCode verify(VerifyCommandOptions options) {
  std::error_code ignored;
  if (options.links &&
      !std::filesystem::exists(std::filesystem::path(options.directory) / "config.resolved.toml", ignored)) {
    throw gridlock::Error(
        {.what = fmt::format("{} is not the directory of one run, and a link holds one", options.directory),
         .hint = "name a run; the report of a study has the links of its figures",
         .key = "--link"});
  }
  std::optional<ProgressLine> line(std::in_place);
  options.verify.on_progress = [&](double fraction) { line->show(fraction, "replayed"); };
  gridlock::VerifiedRuns const found =
      gridlock::verify_all(options.directory, options.verify, [&](std::string const& sentence) {
        line.reset();
        fmt::print("{}\n", sentence);
        std::fflush(stdout);
        line.emplace();
      });
  line.reset();
  if (options.links) print_link(options.directory);
  if (found.different > 0) return ExitCode::run_failed;
  return found.refused > 0 ? ExitCode::bad_input : ExitCode::good;
}

}  // namespace

void add_verify(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand(
      "verify", "Replay a run, or parts of it, and compare it with the hashes and frames that it has recorded");
  auto const options = std::make_shared<VerifyCommandOptions>();
  verb->add_option("DIR", options->directory, "Directory of a run, of a sweep, of a study or of several runs")
      ->required();
  verb->add_option(
          "--windows", options->verify.windows,
          "Replay so many parts of the run, each from a state of checkpoint.keep_states; of a study so many runs; "
          "left out or 0: all of it")
      ->type_name("N")
      ->check(whole_number(0));
  verb->add_option("--seed", options->verify.seed, "Seed of the choice of the parts; left out: 1")
      ->type_name("N")
      ->check(whole_number(0));
  verb->add_option("--window-steps", options->verify.window_steps,
                   "Length of a part in steps; left out: up to the next recorded hash")
      ->type_name("N")
      ->check(whole_number(1));
  verb->add_option("-j,--threads", options->verify.threads,
                   "Threads of exact, tiled, soft and models; 0: one for each core; left out: as configured")
      ->check(whole_number(0, 1024));
  verb->add_flag("--link", options->links,
                 "Print a link as well, with which the page in the browser makes the run again");
  verb->callback([options, &exit_code] { exit_code = verify(*options); });
}

}  // namespace gridlock::cli
