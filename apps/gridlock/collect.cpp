#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "gridlock/workspace/sweep.hpp"
#include "pictures.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

namespace {

struct CollectOptions {
  std::vector<std::string> directories;
  std::string output;
  bool overwrites = false;
};

ExitCode collect(CollectOptions const& options) {
  std::vector<std::filesystem::path> const directories(options.directories.begin(), options.directories.end());
  std::filesystem::path const into =
      options.output.empty() ? directories.front() : std::filesystem::path(options.output);
  gridlock::SweepResult const result = gridlock::collect_sweep(directories, into, options.overwrites);
  draw_pictures(into);
  for (std::string const& note : result.notes) fmt::print(stderr, "note: {}\n", note);
  for (std::string const& message : result.messages) fmt::print(stderr, "error: {}\n", message);
  std::size_t const all = result.rows.row_count();
  std::size_t const good = all - result.failures - result.interruptions;
  fmt::print("{} of {} runs finished; sweep.csv, means.csv and runs/ in {}\n", good, all, into.string());
  return good == all ? ExitCode::good : ExitCode::run_failed;
}

}  // namespace

void add_collect(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb = app.add_subcommand("collect", "Join the shards of a sweep, wherever they were run");
  auto const options = std::make_shared<CollectOptions>();
  verb->add_option("DIR", options->directories, "Directories of the shards, or the one they share")->required();
  verb->add_option("-o,--output", options->output, "Directory for the whole sweep; left out: the first DIR")
      ->type_name("DIR");
  verb->add_flag("--overwrite", options->overwrites, "Replace files that Gridlock has not written");
  verb->callback([options, &exit_code] { exit_code = collect(*options); });
}

}  // namespace gridlock::cli
