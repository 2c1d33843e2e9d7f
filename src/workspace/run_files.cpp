#include "workspace/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/observe/observable.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "workspace/result_files.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

void require_unused(fs::path const& directory) {
  constexpr std::array results{summary_name, "config.resolved.toml", "sweep.csv", "plan.json", "report.html"};
  std::error_code ignored;
  bool const is_used =
      std::ranges::any_of(results, [&](char const* name) { return fs::exists(directory / name, ignored); });
  if (!is_used) return;
  bool const is_unfinished =
      !fs::exists(directory / summary_name, ignored) && fs::exists(directory / "config.resolved.toml", ignored);
  throw Error({.what = fmt::format("{} holds {} already", directory.string(), is_unfinished ? "a run" : "results"),
               .hint = is_unfinished
                           ? "continue it with gridlock resume, name another directory, or replace it: --overwrite, "
                             "in Python overwrite=True"
                           : "name another directory, or replace them: --overwrite, in Python overwrite=True",
               .key = "-o"});
}

}  // namespace

std::vector<fs::path> run_files(fs::path const& directory, Configuration const& configuration) {
  std::vector<fs::path> files;
  for (char const* name : {"config.resolved.toml", "start.xyz", "run.log", "checkpoint.gridlock",
                           "checkpoint.previous.gridlock", "trajectory.h5", "trajectory.h5.part", "series.csv",
                           "hashes.csv", "final.xyz", final_fields_name, final_networks_name, summary_name}) {
    files.push_back(directory / name);
  }
  for (std::string_view const curve : names_of_curves()) files.push_back(directory / fmt::format("{}.csv", curve));
  if (configuration.protocol.empty()) return files;
  for (char const* name : {"stages.csv", "levels.csv", "swap_correlations.csv", "swap_density.csv", "contacts.csv",
                           "shear.csv", "shear_events.csv", "shear_motions.csv", "shear_cycles.csv"}) {
    files.push_back(directory / name);
  }
  return files;
}

void open_result_directory(fs::path const& directory, std::vector<fs::path> results, std::vector<fs::path> inputs,
                           bool overwrites) {
  if (!overwrites) require_unused(directory);
  if (overwrites) protect_inputs(directory, inputs);
  protect_files({.results = std::move(results),
                 .inputs = std::move(inputs),
                 .maker = "",
                 .hint = hint_of_directories,
                 .overwrites = overwrites});
  make_output_directory(directory);
}

void open_run_directory(fs::path const& directory, Setup const& setup, bool overwrites, fs::path const& settings_file) {
  open_result_directory(directory, run_files(directory, setup.configuration),
                        {settings_file, setup.start_file, setup.potential_file}, overwrites);
}

}  // namespace gridlock
