#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/verify.hpp"
#include "workspace/continued_run.hpp"
#include "workspace/study_record.hpp"

namespace gridlock {

namespace {

/// Returns the directories of all runs below a directory, sorted. Errors: Error if there is none.
std::vector<std::filesystem::path> runs_below(std::filesystem::path const& directory) {
  std::error_code error;
  if (!std::filesystem::is_directory(directory, error)) {
    bool const exists = std::filesystem::exists(directory, error);
    throw Error({.what = exists ? fmt::format("{} is not a directory", directory.string())
                                : fmt::format("there is no directory {}", directory.string()),
                 .hint = "name the directory of a run, of a sweep, of a study or of several runs"});
  }
  std::vector<std::filesystem::path> runs;
  for (std::filesystem::recursive_directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().filename() == configuration_name) runs.push_back(entry->path().parent_path());
  }
  if (runs.empty() && std::filesystem::exists(directory / "partial_results", error)) {
    throw Error({.what = fmt::format("the study in {} is not finished", directory.string()),
                 .hint = "finish it by the command that began it, and then verify it"});
  }
  if (runs.empty()) require_run(directory);
  std::ranges::sort(runs);
  return runs;
}

/// Returns the number of runs in the table of a sweep; 0 where there is none.
std::size_t runs_of_sweep(std::filesystem::path const& directory) {
  std::error_code ignored;
  std::filesystem::path const table = directory / "sweep.csv";
  return std::filesystem::exists(table, ignored) ? read_csv(table).row_count() : 0;
}

/// Verifies one run of several. A run that cannot be verified does not keep the others from it.
void add_run(std::filesystem::path const& run, VerifyOptions const& options, VerifiedRuns& all,
             std::function<void(std::string const&)> const& on_line) {
  auto const refuse = [&](std::string const& why) {
    ++all.refused;
    on_line(fmt::format("cannot be verified: {}: {}", run.string(), why));
  };
  try {
    all.runs.push_back(verify_run(run, options));
    ++(all.runs.back().difference.empty() ? all.verified : all.different);
    on_line(to_text(all.runs.back()));
  } catch (Error const& error) {
    refuse(error.problems().front().what);
  } catch (RunFailure const& failure) {
    refuse(failure.what());
  }
}

}  // namespace

VerifiedRuns verify_all(std::filesystem::path const& directory, VerifyOptions const& options,
                        std::function<void(std::string const&)> const& on_line) {
  std::error_code ignored;
  VerifiedRuns all;
  if (std::filesystem::exists(directory / configuration_name, ignored)) {
    all.runs.push_back(verify_run(directory, options));
    ++(all.runs.back().difference.empty() ? all.verified : all.different);
    on_line(to_text(all.runs.back()));
    return all;
  }
  if (has_study_record(directory)) return verify_study(directory, options, on_line);
  std::vector<std::filesystem::path> const runs = runs_below(directory);
  VerifyOptions of_one = options;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    of_one.on_progress = [&](double fraction) {
      if (options.on_progress)
        options.on_progress((static_cast<double>(k) + fraction) / static_cast<double>(runs.size()));
    };
    add_run(runs[k], of_one, all, on_line);
  }
  std::size_t const planned = std::max(runs.size(), runs_of_sweep(directory));
  std::size_t const missing = planned - runs.size();
  all.refused += missing;
  if (missing > 0) {
    on_line(fmt::format("cannot be verified: {} without a {}: {}",
                        missing == 1 ? "a run of the sweep is" : "runs of the sweep are", configuration_name, missing));
  }
  on_line(fmt::format("{} of {} runs verified; {} different, {} cannot be verified", all.verified, planned,
                      all.different, all.refused));
  return all;
}

}  // namespace gridlock
