#include "workspace/sweep_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>
#include <utility>

#include "io/file.hpp"
#include "simulation/settings_difference.hpp"
#include "workspace/result_files.hpp"
#include "workspace/run_files.hpp"
#include "workspace/sweep_plan.hpp"

namespace gridlock {

namespace {

Error in_the_way(std::string what) {
  return Error({.what = std::move(what),
                .hint = "name another directory, or run everything again: --overwrite, in Python overwrite=True",
                .key = "-o"});
}

}  // namespace

bool SweepDirectory::is_ours(std::size_t run) const {
  return !settings_.shard || run % settings_.shard->count == settings_.shard->number - 1;
}

std::filesystem::path SweepDirectory::directory_of(std::size_t run) const {
  return gridlock::directory_of(settings_.directory, plan_.runs[run]);
}

bool SweepDirectory::is_there(std::size_t run) const {
  std::error_code ignored;
  return !settings_.overwrites && std::filesystem::exists(directory_of(run) / "config.resolved.toml", ignored);
}

std::optional<RunSummary> SweepDirectory::recorded(std::size_t run) const {
  return is_there(run) ? read_summary(directory_of(run)) : std::nullopt;
}

std::optional<Error> SweepDirectory::refusal_of(std::size_t run, Setup const& setup) const {
  if (!is_there(run)) return std::nullopt;
  std::string const reason = difference_from_recorded(run, setup);
  if (reason.empty()) return std::nullopt;
  return in_the_way(fmt::format("{} was run with other settings: {}", directory_of(run).string(), reason));
}

/// Returns how the run in the directory differs from this sweep's run; empty if it does not. The number of threads is
/// not compared, since it depends on the other runs of a sweep.
std::string SweepDirectory::difference_from_recorded(std::size_t run, Setup const& setup) const {
  std::filesystem::path const file = directory_of(run) / "config.resolved.toml";
  SettingTexts texts;
  try {
    texts = setting_texts(read_file(file), file.string());
  } catch (Error const& error) {
    return error.problems().front().what;
  }
  auto const difference = find_difference(texts, setting_texts(resolved_configuration(setup), ""));
  if (difference) return to_text(*difference, "it", "this sweep");
  auto const summary = recorded(run);
  return summary && summary->start_hash != setup.simulation->state_hash() ? "it began from another state" : "";
}

void SweepDirectory::require_same_base() const {
  if (settings_.overwrites || !is_of_sweep()) return;
  SweepPlan recorded;
  try {
    recorded = read_plan(settings_.directory);
  } catch (Error const&) {
    return;  // the plan is rewritten, and each existing run is checked
  }
  std::set<std::string> swept(plan_.keys.begin(), plan_.keys.end());
  swept.insert(recorded.keys.begin(), recorded.keys.end());
  auto const difference = find_difference(recorded.base, plan_.base, swept);
  if (difference) {
    throw in_the_way(fmt::format("{} holds a sweep of other settings: {}", settings_.directory.string(),
                                 to_text(*difference, "it", "this one")));
  }
}

bool SweepDirectory::is_of_sweep() const {
  std::error_code ignored;
  std::filesystem::path const plan = settings_.directory / sweep_plan_name;
  if (!std::filesystem::exists(plan, ignored)) return false;
  if (has_list(settings_.directory)) return is_listed(plan);
  try {
    read_plan(settings_.directory);
  } catch (Error const&) {
    // A damaged plan belongs to the sweep if one of its runs is listed; otherwise it is a file of the user.
    return std::ranges::any_of(
        plan_.runs, [&](SweepRun const& run) { return has_list(gridlock::directory_of(settings_.directory, run)); });
  }
  return true;
}

void SweepDirectory::open() const {
  try {
    look_and_open();
  } catch (Error const&) {
    // Another shard may have begun this sweep between two looks.
    if (!settings_.shard || !is_of_sweep()) throw;
    look_and_open();
  }
}

void SweepDirectory::look_and_open() const {
  std::vector<std::filesystem::path> tables;
  for (char const* name : {sweep_plan_name, "sweep.csv", "means.csv"}) tables.push_back(settings_.directory / name);
  std::vector<std::filesystem::path> const inputs = this->inputs();
  if (is_of_sweep()) {
    adopt_results(settings_.directory, tables);
    protect_files({.results = tables,
                   .inputs = inputs,
                   .maker = "",
                   .hint = hint_of_directories,
                   .overwrites = settings_.overwrites});
    if (settings_.overwrites) protect_inputs(settings_.directory, inputs);
  } else {
    open_result_directory(settings_.directory, tables, inputs, settings_.overwrites);
  }
  protect_runs(inputs);
  make_output_directory(settings_.directory);
}

void SweepDirectory::protect_runs(std::vector<std::filesystem::path> const& inputs) const {
  for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
    // resume_in() checks an existing run without a list.
    if (!is_ours(run) || (is_there(run) && !has_list(directory_of(run)))) continue;
    Configuration any_stages;
    any_stages.protocol.emplace_back();
    protect_files({.results = run_files(directory_of(run), any_stages),
                   .inputs = inputs,
                   .maker = "",
                   .hint = hint_of_directories,
                   .overwrites = settings_.overwrites});
  }
}

/// Returns the settings file of the sweep, and the files of starts and potentials of its runs.
std::vector<std::filesystem::path> SweepDirectory::inputs() const {
  std::set<std::filesystem::path> files{settings_.settings_file};
  for (SweepRun const& run : plan_.runs) {
    try {
      Configuration configuration;
      run.settings.read_into(describing(configuration));
      for (std::string const& file : {configuration.disks.file, configuration.engine.potential.file}) {
        if (!file.empty()) files.insert(run.settings.directory() / file);
      }
    } catch (Error const&) {
      continue;  // setting up the run reports the error
    }
  }
  return {files.begin(), files.end()};
}

void SweepDirectory::forget_old_results() const {
  if (!settings_.overwrites) return;
  // Results other than a sweep's are removed; those of a sweep are kept, since other shards may have runs in it.
  if (!is_of_sweep()) remove_results(settings_.directory);
  // Runs that are repeated are removed first, so that an interruption leaves no old runs among new ones.
  std::error_code ignored;
  for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
    if (!is_ours(run)) continue;
    for (char const* name : {"summary.json", "config.resolved.toml"}) {
      std::filesystem::remove(directory_of(run) / name, ignored);
    }
  }
}

}  // namespace gridlock
