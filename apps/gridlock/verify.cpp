#include "gridlock/workspace/verify.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
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

/// Verifies one run of several and prints a line on it. A run that cannot be verified does not keep the others from it.
ExitCode verify_one(std::filesystem::path const& run, gridlock::VerifyOptions const& options) {
  try {
    gridlock::Verification const found = gridlock::verify_run(run, options);
    fmt::print("{}\n", gridlock::to_text(found));
    std::fflush(stdout);
    return found.difference.empty() ? ExitCode::good : ExitCode::run_failed;
  } catch (gridlock::Error const& error) {
    fmt::print("cannot be verified: {}: {}\n", run.string(), error.problems().front().what);
  } catch (gridlock::RunFailure const& failure) {
    fmt::print("cannot be verified: {}: {}\n", run.string(), failure.what());
  }
  return ExitCode::bad_input;
}

/// Returns the number of runs in the table of a sweep; 0 where there is none.
std::size_t runs_of_sweep(std::filesystem::path const& directory) {
  std::error_code ignored;
  std::filesystem::path const table = directory / "sweep.csv";
  return std::filesystem::exists(table, ignored) ? gridlock::read_csv(table).row_count() : 0;
}

/// Verifies runs, of which there should be as many as planned.
ExitCode verify_all(std::vector<std::filesystem::path> const& runs, std::size_t planned,
                    gridlock::VerifyOptions const& options) {
  std::size_t good = 0;
  std::size_t different = 0;
  for (std::filesystem::path const& run : runs) {
    ExitCode const exit_code = verify_one(run, options);
    if (exit_code == ExitCode::good) ++good;
    if (exit_code == ExitCode::run_failed) ++different;
  }
  std::size_t const all = std::max(runs.size(), planned);
  std::size_t const others = all - good - different;
  if (all > runs.size()) fmt::print("cannot be verified: {} runs of the sweep are missing\n", all - runs.size());
  fmt::print("{} of {} runs verified; {} different, {} cannot be verified\n", good, all, different, others);
  if (different > 0) return ExitCode::run_failed;
  return others > 0 ? ExitCode::bad_input : ExitCode::good;
}

ExitCode verify(VerifyCommandOptions options) {
  std::vector<std::filesystem::path> const runs = gridlock::runs_below(options.directory);
  if (runs.size() > 1 || runs.front() != options.directory) {
    if (options.links) {
      throw gridlock::Error({.what = fmt::format("{} holds several runs, and a link one", options.directory),
                             .hint = "name one of its runs",
                             .key = "--link"});
    }
    return verify_all(runs, runs_of_sweep(options.directory), options.verify);
  }
  std::optional<ProgressLine> line(std::in_place);
  options.verify.on_progress = [&](double fraction) { line->show(fraction, "replayed"); };
  gridlock::Verification const found = gridlock::verify_run(runs.front(), options.verify);
  line.reset();
  fmt::print("{}\n", gridlock::to_text(found));
  if (options.links) print_link(runs.front());
  return found.difference.empty() ? ExitCode::good : ExitCode::run_failed;
}

}  // namespace

void add_verify(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand(
      "verify", "Replay a run, or parts of it, and compare it with the hashes and frames that it has recorded");
  auto const options = std::make_shared<VerifyCommandOptions>();
  verb->add_option("DIR", options->directory, "Directory of a run, of a sweep or of several runs")->required();
  verb->add_option("--windows", options->verify.windows,
                   "Replay so many parts of the run, each from a state of checkpoint.keep_states; left out: all of it")
      ->type_name("N")
      ->check(whole_number(1));
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
