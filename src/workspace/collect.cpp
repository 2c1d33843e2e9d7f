#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "simulation/settings_difference.hpp"
#include "workspace/result_files.hpp"
#include "workspace/run_files.hpp"
#include "workspace/summary.hpp"
#include "workspace/sweep_plan.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

Error different_sweeps(std::string what) {
  return Error({.what = std::move(what), .hint = "collect them one by one, into directories of their own with -o"});
}

/// Returns a plan with the runs of all plans; runs with the same name are listed once.
SweepPlan merged_plan(std::vector<fs::path> const& directories) {
  SweepPlan merged = read_plan(directories.front());
  std::set<std::string> known;
  for (fs::path const& directory : directories) {
    SweepPlan const plan = read_plan(directory);
    if (plan.keys != merged.keys) {
      throw different_sweeps(fmt::format("the sweeps in {} and {} vary different settings",
                                         directories.front().string(), directory.string()));
    }
    if (auto const difference = find_difference(merged.base, plan.base)) {
      throw different_sweeps("the sweeps have different settings in common: " +
                             to_text(*difference, directories.front().string(), directory.string()));
    }
    for (SweepRun const& run : plan.runs) {
      if (known.insert(run.name).second && &directory != &directories.front()) merged.runs.push_back(run);
    }
  }
  return merged;
}

/// A run in one of the directories.
struct RecordedRun {
  fs::path directory;
  std::optional<RunSummary> summary;
};

/// Returns all copies of a run that has begun in several directories. Errors: Error if copies have different settings.
std::vector<RecordedRun> recorded_runs(std::vector<fs::path> const& directories, SweepRun const& run) {
  std::vector<RecordedRun> runs;
  std::optional<SettingTexts> settings;
  for (fs::path const& sweep : directories) {
    RecordedRun recorded{.directory = directory_of(sweep, run), .summary = {}};
    fs::path const configuration = recorded.directory / "config.resolved.toml";
    std::error_code ignored;
    if (!fs::exists(configuration, ignored)) continue;
    recorded.summary = read_summary(recorded.directory);
    SettingTexts texts = setting_texts(read_file(configuration), configuration.string());
    if (!settings) settings = texts;
    if (auto const difference = find_difference(*settings, texts)) {
      throw different_sweeps(
          fmt::format("run {} has different settings: {}", run.name,
                      to_text(*difference, runs.front().directory.string(), recorded.directory.string())));
    }
    for (RecordedRun const& other : runs) {
      if (other.summary && recorded.summary && other.summary->start_hash != recorded.summary->start_hash) {
        throw different_sweeps(fmt::format("run {} began from another state in {} than in {}", run.name,
                                           recorded.directory.string(), other.directory.string()));
      }
    }
    runs.push_back(std::move(recorded));
  }
  return runs;
}

/// Returns a finished copy, or else any copy with a summary; null if there is none.
RecordedRun const* best_of(std::vector<RecordedRun> const& runs) {
  RecordedRun const* best = nullptr;
  for (RecordedRun const& run : runs) {
    if (!run.summary) continue;
    if (run.summary->status == RunStatus::finished) return &run;
    best = &run;
  }
  return best;
}

/// Throws an Error if a symbolic link leads `path` out of the output directory, since collected data may be hostile.
void require_inside(fs::path const& into, fs::path const& path) {
  std::error_code error;
  fs::path const base = fs::canonical(into, error);
  fs::path const real = error ? fs::path() : fs::weakly_canonical(path, error);
  auto const [base_end, real_end] = std::mismatch(base.begin(), base.end(), real.begin(), real.end());
  std::error_code ignored;
  // Writing through a link without a target would create its target, which may be anywhere.
  bool const is_dangling = fs::is_symlink(path, ignored) && !fs::exists(path, ignored);
  if (!error && !is_dangling && base_end == base.end()) return;
  throw Error({.what = fmt::format("a link leads {} out of the output directory {}", path.string(), into.string()),
               .hint = "name another output directory with -o, or remove the link",
               .key = "-o"});
}

/// Throws an Error if a link in the output directory leads out of it, since tables and pictures are written through
/// links.
void require_no_links_out(fs::path const& into) {
  std::error_code ignored;
  for (auto const& entry : fs::directory_iterator(into, ignored)) {
    // runs/ receives only copies of runs, and copy_run() checks each of their paths.
    if (entry.is_symlink(ignored) && entry.path().filename() != "runs") require_inside(into, entry.path());
  }
}

/// Copies a file; the copy appears complete or not at all, and replaces a link of its name instead of following it.
void copy_whole(fs::path const& from, fs::path const& to) {
  AtomicFile file(to, AtName::replaced);
  try {
    fs::copy_file(from, file.location(), fs::copy_options::overwrite_existing);
  } catch (fs::filesystem_error const& error) {
    throw RunFailure(fmt::format("cannot copy {} to {}: {}", from.string(), to.string(), error.code().message()));
  }
  file.commit();
}

/// Returns the files of a run without its summary and without hidden files, which are locks and temporary files.
std::vector<std::string> names_of_files(RecordedRun const& run) {
  std::vector<std::string> names;
  for (auto const& entry : fs::directory_iterator(run.directory)) {
    std::error_code ignored;
    std::string const name = entry.path().filename().string();
    if (entry.is_regular_file(ignored) && !name.starts_with('.') && name != summary_name) names.push_back(name);
  }
  return names;
}

/// Copies a run. The old summary is removed first and the new one is copied last, so that only complete runs have one.
void copy_run(RecordedRun const& run, fs::path const& into, fs::path const& target) {
  require_inside(into, target);
  make_output_directory(target);
  remove_results(target);
  for (std::string const& name : names_of_files(run)) {
    record_result(target / name);
    copy_whole(run.directory / name, target / name);
  }
  record_result(target / summary_name);
  copy_whole(run.directory / summary_name, target / summary_name);
}

/// Throws an Error before any copy if files would be replaced that Gridlock did not write. If the output directory is
/// also collected, its results count as Gridlock's even without the hidden lists.
void protect_target(std::vector<fs::path> const& directories, fs::path const& into, bool overwrites,
                    SweepPlan const& plan, std::vector<std::optional<RecordedRun>> const& best) {
  bool const is_collected = std::ranges::any_of(directories, [&](fs::path const& directory) {
    std::error_code ignored;
    return fs::equivalent(directory, into, ignored);
  });
  auto const protect = [&](fs::path const& directory, std::vector<fs::path> const& results) {
    if (is_collected) adopt_results(directory, results);
    protect_files(
        {.results = results, .inputs = {}, .maker = "", .hint = hint_of_directories, .overwrites = overwrites});
  };
  protect(into, {into / sweep_plan_name, into / "sweep.csv", into / "means.csv"});
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    fs::path const target = directory_of(into, plan.runs[run]);
    std::error_code ignored;
    if (!best[run] || fs::equivalent(best[run]->directory, target, ignored)) continue;
    Configuration any_stages;
    any_stages.protocol.emplace_back();
    std::vector<fs::path> results = run_files(target, any_stages);
    for (std::string const& name : names_of_files(*best[run])) results.push_back(target / name);
    protect(target, results);
  }
}

}  // namespace

SweepResult collect_sweep(std::vector<fs::path> const& directories, fs::path const& into, bool overwrites) {
  SweepPlan const plan = merged_plan(directories);
  std::vector<std::optional<RecordedRun>> best(plan.runs.size());
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    std::vector<RecordedRun> const recorded = recorded_runs(directories, plan.runs[run]);
    if (RecordedRun const* const found = best_of(recorded)) best[run] = *found;
  }
  if (fs::exists(into)) require_no_links_out(into);
  protect_target(directories, into, overwrites, plan, best);
  make_output_directory(into);
  DirectoryLock const lock(into, Sharing::alone);
  std::vector<SweepOutcome> outcomes(plan.runs.size());
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    if (!best[run]) continue;
    outcomes[run] = outcome_of(*best[run]->summary);
    fs::path const target = directory_of(into, plan.runs[run]);
    std::error_code ignored;
    if (!fs::equivalent(best[run]->directory, target, ignored)) copy_run(*best[run], into, target);
  }
  write_plan(plan, into);
  SweepResult result = result_of(plan, outcomes);
  write_tables(result, into);
  return result;
}

}  // namespace gridlock
