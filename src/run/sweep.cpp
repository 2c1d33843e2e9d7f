#include "gridlock/run/sweep.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <mutex>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "gridlock/run/run_directory.hpp"
#include "run/sweep_tables.hpp"
#include "run/team.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

constexpr char const* plan_name = "plan.json";

/// The work of a run in disk-steps, as far as its settings tell: only for the order and the progress.
double cost_of(Setup const& setup) {
  RunSettings const& run = setup.configuration.run;
  double const disks = static_cast<double>(setup.state.disks.size());
  double const duration = step_duration(setup.configuration.engine, setup.state);
  double steps = std::numeric_limits<double>::infinity();
  if (run.steps) steps = std::min(steps, static_cast<double>(*run.steps));
  if (run.time) steps = std::min(steps, *run.time / duration);
  // A disk of a dense fluid collides a few times while it travels ten of the default time steps.
  if (run.collisions_per_disk) steps = std::min(steps, *run.collisions_per_disk * 3.0);
  return disks * steps + 1.0;
}

std::filesystem::path directory_of(std::filesystem::path const& sweep, SweepRun const& run) {
  return sweep / "runs" / run.name;
}

SweepOutcome outcome_of(RunSummary const& summary) {
  return {.has_begun = true,
          .ending = summary.ending,
          .message = summary.failure,
          .state_hash = summary.state_hash,
          .seconds = summary.seconds,
          .results = summary.results};
}

SweepOutcome outcome_of(RunRecord const& record) {
  return {.has_begun = true,
          .ending = record.ending,
          .message = record.failure,
          .state_hash = record.state_hash,
          .seconds = record.seconds,
          .results = record.results};
}

Json to_json(SweepPlan const& plan) {
  Json json{{"keys", plan.keys}, {"runs", Json::array()}};
  for (SweepRun const& run : plan.runs) json["runs"].push_back({{"name", run.name}, {"values", run.values}});
  return json;
}

/// What is in the way of a sweep in a directory that is used already: results that are not of a sweep.
void open_sweep_directory(std::filesystem::path const& directory, bool overwrites) {
  std::error_code ignored;
  if (std::filesystem::exists(directory / plan_name, ignored)) {
    make_output_directory(directory);
  } else {
    open_run_directory(directory, overwrites);
  }
}

/// A sweep being carried out.
class SweepInProgress {
 public:
  SweepInProgress(SweepPlan const& plan, SweepSettings const& settings)
      : plan_(plan), settings_(settings), outcomes_(plan.runs.size()), errors_(plan.runs.size()) {}

  void run() {
    std::vector<double> const costs = estimate_costs();
    require_one_good();
    open_sweep_directory(settings_.directory, settings_.overwrites);
    DirectoryLock const lock(settings_.directory, settings_.shard ? Sharing::with_others : Sharing::alone);
    write_file(settings_.directory / plan_name, to_json(plan_).dump(1) + '\n');
    auto const start = std::chrono::steady_clock::now();
    Team team(costs, [&](double fraction, std::size_t finished) {
      double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return !settings_.on_progress ||
             settings_.on_progress(
                 {.finished = finished, .all = plan_.runs.size(), .fraction = fraction, .seconds = seconds});
    });
    team.run_all(settings_.threads, [&](std::size_t run) {
      if (!errors_[run] && is_ours(run)) outcomes_[run] = carry_out(run, team);
    });
  }

  [[nodiscard]] std::vector<SweepOutcome> const& outcomes() const { return outcomes_; }

 private:
  [[nodiscard]] bool is_ours(std::size_t run) const {
    return !settings_.shard || run % settings_.shard->count == settings_.shard->number - 1;
  }

  /// All cores are busy with runs already, so each of them has one.
  [[nodiscard]] Setup set_up_one(std::size_t run) const {
    Setup setup = set_up(plan_.runs[run].settings);
    if (setup.configuration.engine.threads == 0) setup.configuration.engine.threads = 1;
    return setup;
  }

  /// Sets up every run once, for its cost and to know which cannot be made, are there already, or are in the way.
  std::vector<double> estimate_costs() {
    std::vector<double> costs(plan_.runs.size(), 0.0);
    tbb::parallel_for(std::size_t{0}, plan_.runs.size(), [&](std::size_t run) {
      try {
        Setup const setup = set_up_one(run);
        require_same_run(run, setup);
        costs[run] = is_ours(run) && !is_finished(run) ? cost_of(setup) : 0.0;
      } catch (Error const& error) {
        errors_[run] = error;
        outcomes_[run] = {.has_begun = false, .ending = Ending::failed, .message = error.what(), .results = {}};
      }
    });
    if (is_in_the_way_) throw *is_in_the_way_;
    return costs;
  }

  /// A mistake that spoils every run is the user's input, not a failure of some runs.
  void require_one_good() const {
    bool const is_one_good = std::ranges::any_of(errors_, [](auto const& error) { return !error; });
    if (!is_one_good) throw *errors_.front();
  }

  /// Whether the run is in its directory already, finished or not.
  [[nodiscard]] bool is_there(std::size_t run) const {
    std::error_code ignored;
    return !settings_.overwrites && std::filesystem::exists(directory_of(run) / "config.resolved.toml", ignored);
  }
  [[nodiscard]] bool is_finished(std::size_t run) const {
    auto const summary = is_there(run) ? read_summary(directory_of(run)) : std::nullopt;
    return summary && summary->ending == Ending::finished;
  }
  [[nodiscard]] std::filesystem::path directory_of(std::size_t run) const {
    return gridlock::directory_of(settings_.directory, plan_.runs[run]);
  }

  void require_same_run(std::size_t run, Setup const& setup) {
    if (!is_there(run)) return;
    auto const summary = read_summary(directory_of(run));
    bool const has_same_start = !summary || summary->start_hash == hash(setup.state);
    if (has_same_start && read_file(directory_of(run) / "config.resolved.toml") == resolved_configuration(setup))
      return;
    std::scoped_lock const guard(mutex_);
    is_in_the_way_ = Error({.what = fmt::format("{} was run with other settings", directory_of(run).string()),
                            .hint = "name another directory with -o, or add --overwrite to run everything again",
                            .key = "-o"});
  }

  SweepOutcome carry_out(std::size_t run, Team& team) const {
    RunHooks const hooks{.on_progress = [&](Progress const& progress) { return team.report(run, progress.fraction); },
                         .on_note = {},
                         .threads = std::nullopt};
    try {
      if (is_finished(run)) return outcome_of(*read_summary(directory_of(run)));
      return outcome_of(is_there(run) ? resume_in(directory_of(run), hooks)
                                      : run_in(directory_of(run), set_up_one(run), hooks));
    } catch (std::exception const& error) {
      return {.has_begun = true, .ending = Ending::failed, .message = error.what(), .results = {}};
    }
  }

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  std::vector<SweepOutcome> outcomes_;
  std::vector<std::optional<Error>> errors_;
  std::mutex mutex_;
  std::optional<Error> is_in_the_way_;
};

void write_tables(SweepResult const& result, std::filesystem::path const& directory) {
  write_csv(result.rows, directory / "sweep.csv");
  write_csv(result.means, directory / "means.csv");
}

/// The keys, names and values of a plan that was written by a sweep; nothing to run it with.
SweepPlan read_plan(std::filesystem::path const& directory) {
  std::filesystem::path const path = directory / plan_name;
  std::string const text = read_file(path);
  try {
    Json const json = Json::parse(text);
    SweepPlan plan{.keys = json.at("keys").get<std::vector<std::string>>(), .runs = {}};
    for (Json const& run : json.at("runs")) {
      plan.runs.push_back({.name = run.at("name").get<std::string>(),
                           .values = run.at("values").get<std::vector<std::string>>(),
                           .settings = {}});
      if (plan.runs.back().values.size() != plan.keys.size()) throw std::runtime_error("a run lacks values");
    }
    return plan;
  } catch (std::exception const& error) {
    throw Error({.what = fmt::format("{} is damaged: {}", path.string(), error.what()),
                 .hint = "run the sweep again: it keeps the runs that are finished",
                 .file = path.string()});
  }
}

/// All runs of several plans, each once.
SweepPlan merged_plan(std::vector<std::filesystem::path> const& directories) {
  SweepPlan merged = read_plan(directories.front());
  for (std::filesystem::path const& directory : directories) {
    SweepPlan const plan = read_plan(directory);
    if (plan.keys != merged.keys) {
      throw Error({.what = fmt::format("the sweeps in {} and {} vary different settings", directories.front().string(),
                                       directory.string()),
                   .hint = "collect them one by one"});
    }
    for (SweepRun const& run : plan.runs) {
      bool const is_known = std::ranges::any_of(merged.runs, [&](SweepRun const& r) { return r.name == run.name; });
      if (!is_known) merged.runs.push_back(run);
    }
  }
  return merged;
}

/// The directory in which a run came farthest: to its end, or at all.
std::optional<std::filesystem::path> best_of(std::vector<std::filesystem::path> const& directories,
                                             SweepRun const& run) {
  std::optional<std::filesystem::path> best;
  for (std::filesystem::path const& directory : directories) {
    auto const summary = read_summary(directory_of(directory, run));
    if (!summary) continue;
    if (summary->ending == Ending::finished) return directory;
    best = directory;
  }
  return best;
}

}  // namespace

SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings) {
  SweepInProgress sweep(plan, settings);
  sweep.run();
  SweepResult result = result_of(plan, sweep.outcomes());
  // The tables of a part would be taken for the whole: collect_sweep() makes them when all parts are there.
  if (!settings.shard) write_tables(result, settings.directory);
  return result;
}

SweepResult collect_sweep(std::vector<std::filesystem::path> const& directories, std::filesystem::path const& into) {
  SweepPlan const plan = merged_plan(directories);
  make_output_directory(into);
  DirectoryLock const lock(into, Sharing::alone);
  std::vector<SweepOutcome> outcomes(plan.runs.size());
  for (std::size_t run = 0; run < plan.runs.size(); ++run) {
    auto const from = best_of(directories, plan.runs[run]);
    if (!from) continue;
    std::filesystem::path const source = directory_of(*from, plan.runs[run]);
    outcomes[run] = outcome_of(*read_summary(source));
    std::filesystem::path const target = directory_of(into, plan.runs[run]);
    std::error_code ignored;
    if (std::filesystem::equivalent(source, target, ignored)) continue;
    std::filesystem::create_directories(target);
    std::filesystem::copy(source, target,
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
  }
  write_file(into / plan_name, to_json(plan).dump(1) + '\n');
  SweepResult result = result_of(plan, outcomes);
  write_tables(result, into);
  return result;
}

}  // namespace gridlock
