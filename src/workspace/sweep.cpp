#include "gridlock/workspace/sweep.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "simulation/expected_work.hpp"
#include "simulation/memory.hpp"
#include "simulation/settings_difference.hpp"
#include "workspace/job_pool.hpp"
#include "workspace/result_files.hpp"
#include "workspace/sweep_plan.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {

namespace {

/// The rest is for what the estimates leave out.
constexpr double share_of_memory = 0.8;

std::string reason_of(std::exception const& error) {
  return dynamic_cast<std::bad_alloc const*>(&error) == nullptr ? error.what() : "not enough memory";
}

SweepOutcome outcome_of(RunRecord const& record) {
  return {.has_begun = true,
          .status = record.status,
          .message = record.failure,
          .state_hash = record.state_hash,
          .seconds = record.seconds,
          .results = record.results};
}

/// What is in the way of a sweep in a directory that is used already: results that are not of a sweep.
void open_sweep_directory(std::filesystem::path const& directory, bool overwrites) {
  std::error_code ignored;
  if (std::filesystem::exists(directory / sweep_plan_name, ignored)) {
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
        notes_(plan.runs.size()) {}

  void run() {
    set_up_all();
    require_one_good();
    require_same_base();
    share_out_threads();
    open_sweep_directory(settings_.directory, settings_.overwrites);
    DirectoryLock const lock(settings_.directory, settings_.shard ? Sharing::with_others : Sharing::alone);
    if (settings_.overwrites) {
      std::error_code ignored;
      // Results of something else; a sweep that is there already keeps the runs of other shards.
      if (!std::filesystem::exists(settings_.directory / sweep_plan_name, ignored)) remove_results(settings_.directory);
      forget_all();
    }
    write_plan(plan_, settings_.directory);
    carry_out_all();
  }

  [[nodiscard]] std::vector<SweepOutcome> const& outcomes() const { return outcomes_; }
  [[nodiscard]] std::vector<std::string> notes() const {
    std::vector<std::vector<SetupNote>> notes;
    for (auto const& run : notes_) {
      if (run) notes.push_back(*run);
    }
    return notes_on(notes);
  }

 private:
  [[nodiscard]] bool is_ours(std::size_t run) const {
    return !settings_.shard || run % settings_.shard->count == settings_.shard->number - 1;
  }

  /// Sets up every run once, to know what it takes and which cannot be made, are there already, or are in the way.
  void set_up_all() {
    std::vector<char> lacks_memory(plan_.runs.size(), 0);
    tbb::task_arena(jobs_for(settings_.threads)).execute([&] {
      tbb::parallel_for(std::size_t{0}, plan_.runs.size(), [&](std::size_t run) {
        try {
          look_at(run);
        } catch (std::bad_alloc const&) {
          lacks_memory[run] = 1;
        }
      });
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
      // Only to be looked at.
      Setup const setup = set_up(plan_.runs[run].settings, {.threads = 1});
      notes_[run] = setup.notes;
      require_same_run(run, setup);
      if (!is_ours(run)) return;
      // Where this call does not come to the run, the tables list what earlier ones have made of it.
      if (auto const summary = recorded(run)) outcomes_[run] = outcome_of(*summary);
      if (is_finished(outcomes_[run])) return;
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
    outcomes_[run] = {.has_begun = false, .status = RunStatus::failed, .message = reason_of(error), .results = {}};
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

  /// A sweep in the directory that has other settings in common: its runs and these belong in different tables.
  void require_same_base() const {
    std::error_code ignored;
    if (settings_.overwrites || !std::filesystem::exists(settings_.directory / sweep_plan_name, ignored)) return;
    SweepPlan recorded;
    try {
      recorded = read_plan(settings_.directory);
    } catch (Error const&) {
      return;  // it is written again, and what runs there are is checked one by one
    }
    std::set<std::string> swept(plan_.keys.begin(), plan_.keys.end());
    swept.insert(recorded.keys.begin(), recorded.keys.end());
    auto const difference = find_difference(recorded.base, plan_.base, swept);
    if (difference) {
      throw in_the_way(fmt::format("{} holds a sweep of other settings: {}", settings_.directory.string(),
                                   to_text(*difference, "it", "this one")));
    }
  }

  /// What is to be made anew is gone at once, so that an interruption leaves no old runs among the new ones.
  void forget_all() const {
    std::error_code ignored;
    for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
      if (!is_ours(run)) continue;
      for (char const* name : {"summary.json", "config.resolved.toml"}) {
        std::filesystem::remove(directory_of(run) / name, ignored);
      }
    }
  }

  void carry_out_all() {
    std::vector<std::size_t> open;
    std::vector<double> work;
    std::size_t ours = 0;
    for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
      if (is_ours(run)) ++ours;
      if (prospects_[run].work <= 0.0) continue;
      open.push_back(run);
      work.push_back(prospects_[run].work);
    }
    auto const start = std::chrono::steady_clock::now();
    JobPool job_pool(work, [&](double fraction, std::size_t finished) {
      double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      return !settings_.on_progress ||
             settings_.on_progress(
                 {.finished = ours - open.size() + finished, .all = ours, .fraction = fraction, .seconds = seconds});
    });
    job_pool.run_all(settings_.threads, [&](std::size_t k) {
      std::size_t const run = open[k];
      outcomes_[run] = carry_out(run, job_pool, [&, k](double share) { return job_pool.report(k, share); });
    });
  }

  /// Whether the run is in its directory already, finished or not.
  [[nodiscard]] bool is_there(std::size_t run) const {
    std::error_code ignored;
    return !settings_.overwrites && std::filesystem::exists(directory_of(run) / "config.resolved.toml", ignored);
  }
  /// How the run in the directory has ended; nothing where there is none, or none that has ended.
  [[nodiscard]] std::optional<RunSummary> recorded(std::size_t run) const {
    return is_there(run) ? read_summary(directory_of(run)) : std::nullopt;
  }
  [[nodiscard]] static bool is_finished(SweepOutcome const& outcome) {
    return outcome.has_begun && outcome.status == RunStatus::finished;
  }
  [[nodiscard]] std::filesystem::path directory_of(std::size_t run) const {
    return gridlock::directory_of(settings_.directory, plan_.runs[run]);
  }

  [[nodiscard]] static Error in_the_way(std::string what) {
    return Error({.what = std::move(what),
                  .hint = "name another directory with -o, or add --overwrite to run everything again",
                  .key = "-o"});
  }

  void require_same_run(std::size_t run, Setup const& setup) {
    if (!is_there(run)) return;
    std::string const reason = difference_from_recorded(run, setup);
    if (reason.empty()) return;
    std::scoped_lock const guard(mutex_);
    is_in_the_way_ = in_the_way(fmt::format("{} was run with other settings: {}", directory_of(run).string(), reason));
  }

  /// What the directory of the run says of another run; empty where it is this one, on whatever number of threads it was
  /// begun: the share of the cores that a run gets is another in another sweep.
  [[nodiscard]] std::string difference_from_recorded(std::size_t run, Setup const& setup) const {
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

  SweepOutcome carry_out(std::size_t run, JobPool const& job_pool, std::function<bool(double)> const& report) {
    Prospect const& prospect = prospects_[run];
    RunHooks const hooks{.on_progress = [&](Progress const& progress) { return report(progress.fraction); },
                         .on_note = {},
                         .threads = prospect.threads};
    try {
      // Others that share the directory may have been faster.
      if (auto const summary = recorded(run); summary && is_finished(outcome_of(*summary))) {
        return outcome_of(*summary);
      }
      MemoryBudget::Part const memory(memory_, prospect.bytes);
      if (job_pool.is_stopped()) return outcomes_[run];
      if (is_there(run)) return outcome_of(resume_in(directory_of(run), hooks));
      SettingsFile settings = plan_.runs[run].settings;
      // What is recorded is what is used.
      if (prospect.takes_threads) settings.set(fmt::format("engine.threads={}", prospect.threads));
      return outcome_of(run_in(directory_of(run), set_up(settings), hooks));
    } catch (std::exception const& error) {
      return {.has_begun = true, .status = RunStatus::failed, .message = reason_of(error), .results = {}};
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
  std::vector<std::optional<std::vector<SetupNote>>> notes_;  ///< of the runs that can be set up
  std::mutex mutex_;
  std::optional<Error> is_in_the_way_;
};

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

}  // namespace gridlock
