#include "gridlock/run/sweep.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <new>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/file.hpp"
#include "gridlock/run/run_directory.hpp"
#include "run/expected_work.hpp"
#include "run/memory.hpp"
#include "run/sweep_tables.hpp"
#include "run/team.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

constexpr char const* plan_name = "plan.json";

/// The rest is for what the estimates leave out.
constexpr double share_of_memory = 0.8;

std::string reason_of(std::exception const& error) {
  return dynamic_cast<std::bad_alloc const*>(&error) == nullptr ? error.what() : "not enough memory";
}

/// Whether more threads than one are of any use to it.
bool uses_threads(Configuration const& configuration) {
  return configuration.is_of_model() || configuration.engine.kind == "tiled";
}

/// The threads in a resolved configuration; nothing where it is damaged.
std::optional<std::uint64_t> threads_in(std::string const& resolved) {
  try {
    Configuration configuration;
    SettingsFile::from_text(resolved, "").read_into(describing(configuration));
    return configuration.engine.threads;
  } catch (Error const&) {
    return std::nullopt;
  }
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
      : plan_(plan),
        settings_(settings),
        memory_(share_of_memory * free_memory()),
        outcomes_(plan.runs.size()),
        errors_(plan.runs.size()),
        prospects_(plan.runs.size()),
        idle_settings_(plan.runs.size()) {}

  void run() {
    set_up_all();
    require_one_good();
    share_out_threads();
    open_sweep_directory(settings_.directory, settings_.overwrites);
    DirectoryLock const lock(settings_.directory, settings_.shard ? Sharing::with_others : Sharing::alone);
    write_file(settings_.directory / plan_name, to_json(plan_).dump(1) + '\n');
    auto const start = std::chrono::steady_clock::now();
    std::vector<double> work;
    for (Prospect const& prospect : prospects_) work.push_back(prospect.work);
    Team team(work, [&](double fraction, std::size_t finished) {
      double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return !settings_.on_progress ||
             settings_.on_progress(
                 {.finished = finished, .all = plan_.runs.size(), .fraction = fraction, .seconds = seconds});
    });
    team.run_all(settings_.threads, [&](std::size_t run) {
      if (!has_failed(run) && is_ours(run)) outcomes_[run] = carry_out(run, team);
    });
  }

  [[nodiscard]] std::vector<SweepOutcome> const& outcomes() const { return outcomes_; }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::vector<IdleSetting>> idle;
    for (auto const& settings : idle_settings_) {
      if (settings) idle.push_back(*settings);
    }
    return notes_on(idle);
  }

 private:
  [[nodiscard]] bool is_ours(std::size_t run) const {
    return !settings_.shard || run % settings_.shard->count == settings_.shard->number - 1;
  }

  [[nodiscard]] bool has_failed(std::size_t run) const { return outcomes_[run].ending == Ending::failed; }

  /// Sets up every run once, to know what it takes and which cannot be made, are there already, or are in the way.
  void set_up_all() {
    std::vector<char> lacks_memory(plan_.runs.size(), 0);
    tbb::parallel_for(std::size_t{0}, plan_.runs.size(), [&](std::size_t run) {
      try {
        look_at(run);
      } catch (std::bad_alloc const&) {
        lacks_memory[run] = 1;
      }
    });
    // What did not fit beside others may fit alone.
    for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
      if (lacks_memory[run] == 0) continue;
      try {
        look_at(run);
      } catch (std::bad_alloc const& error) {
        note_failure(run, error);
      }
    }
    if (is_in_the_way_) throw *is_in_the_way_;
  }

  /// Throws std::bad_alloc; any other failure is noted.
  void look_at(std::size_t run) {
    try {
      Configuration configuration;
      plan_.runs[run].settings.read_into(describing(configuration));
      MemoryBudget::Part const memory(memory_, expected_memory(configuration));
      Setup setup = set_up(plan_.runs[run].settings);
      idle_settings_[run] = setup.idle_settings;
      require_same_run(run, setup);
      if (!is_ours(run) || is_finished(run)) return;
      auto const [work, bytes] = expectation_of(setup);
      std::uint64_t const threads = setup.configuration.engine.threads;
      bool const gains = uses_threads(setup.configuration);
      prospects_[run] = {.work = work,
                         .bytes = bytes,
                         .threads = gains && threads > 0 ? threads : 1,
                         .takes_threads = gains && threads == 0};
    } catch (std::bad_alloc const&) {
      throw;
    } catch (Error const& error) {
      note_failure(run, error);
      errors_[run] = error;
    } catch (std::exception const& error) {
      note_failure(run, error);
    }
  }

  void note_failure(std::size_t run, std::exception const& error) {
    outcomes_[run] = {.has_begun = false, .ending = Ending::failed, .message = reason_of(error), .results = {}};
  }

  /// A mistake that spoils every run is the user's input, not a failure of some runs.
  void require_one_good() const {
    bool const are_all_mistaken = std::ranges::all_of(errors_, [](auto const& error) { return error.has_value(); });
    if (are_all_mistaken) throw *errors_.front();
  }

  /// Where there are fewer runs than cores, those that can use several get what the others leave, the longest ones most.
  void share_out_threads() {
    std::vector<std::size_t> takers;
    auto left = static_cast<std::uint64_t>(jobs_for(settings_.threads));
    for (std::size_t run = 0; run < prospects_.size(); ++run) {
      if (prospects_[run].work > 0.0) left -= std::min(left, prospects_[run].threads);
      if (prospects_[run].takes_threads) takers.push_back(run);
    }
    if (takers.empty()) return;
    std::ranges::stable_sort(takers, std::ranges::greater{}, [&](std::size_t run) { return prospects_[run].work; });
    for (std::size_t k = 0; k < takers.size(); ++k) {
      prospects_[takers[k]].threads += left / takers.size() + (k < left % takers.size() ? 1 : 0);
    }
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

  void require_same_run(std::size_t run, Setup& setup) {
    if (!is_there(run)) return;
    auto const summary = read_summary(directory_of(run));
    bool const has_same_start = !summary || summary->start_hash == hash(setup.state);
    if (has_same_start && is_recorded(run, setup)) return;
    std::scoped_lock const guard(mutex_);
    is_in_the_way_ = Error({.what = fmt::format("{} was run with other settings", directory_of(run).string()),
                            .hint = "name another directory with -o, or add --overwrite to run everything again",
                            .key = "-o"});
  }

  /// Whether the directory of the run says the same settings, on whatever number of threads it was begun: the bits do
  /// not depend on it, and the share of the cores that a run gets is another in another sweep.
  [[nodiscard]] bool is_recorded(std::size_t run, Setup& setup) const {
    std::string const recorded = read_file(directory_of(run) / "config.resolved.toml");
    auto const threads = threads_in(recorded);
    if (!threads) return false;
    std::uint64_t const own = std::exchange(setup.configuration.engine.threads, *threads);
    bool const is_same = recorded == resolved_configuration(setup);
    setup.configuration.engine.threads = own;
    return is_same;
  }

  SweepOutcome carry_out(std::size_t run, Team& team) {
    Prospect const& prospect = prospects_[run];
    RunHooks const hooks{.on_progress = [&](Progress const& progress) { return team.report(run, progress.fraction); },
                         .on_note = {},
                         .threads = prospect.threads};
    try {
      if (is_finished(run)) return outcome_of(*read_summary(directory_of(run)));
      MemoryBudget::Part const memory(memory_, prospect.bytes);
      if (team.is_stopped()) return {};
      if (is_there(run)) return outcome_of(resume_in(directory_of(run), hooks));
      Setup setup = set_up(plan_.runs[run].settings);
      // What is recorded is what is used.
      if (prospect.takes_threads) setup.configuration.engine.threads = prospect.threads;
      return outcome_of(run_in(directory_of(run), setup, hooks));
    } catch (std::exception const& error) {
      return {.has_begun = true, .ending = Ending::failed, .message = reason_of(error), .results = {}};
    }
  }

  /// What is known of a run before it begins.
  struct Prospect {
    double work = 0.0;  ///< 0: there is nothing to do, it is finished, another's, or cannot be made
    double bytes = 0.0;
    std::uint64_t threads = 0;
    bool takes_threads = false;  ///< as many as it is given: the user has set no number
  };

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  MemoryBudget memory_;
  std::vector<SweepOutcome> outcomes_;
  std::vector<std::optional<Error>> errors_;
  std::vector<Prospect> prospects_;
  std::vector<std::optional<std::vector<IdleSetting>>> idle_settings_;  ///< of the runs that can be set up
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
  result.notes = sweep.notes();
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
