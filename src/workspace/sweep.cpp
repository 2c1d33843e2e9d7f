#include "gridlock/workspace/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include "gridlock/workspace/run_directory.hpp"
#include "simulation/memory.hpp"
#include "workspace/job_pool.hpp"
#include "workspace/sweep_directory.hpp"
#include "workspace/sweep_plan.hpp"
#include "workspace/sweep_setup.hpp"
#include "workspace/sweep_tables.hpp"

namespace gridlock {

namespace {

/// The rest is for what the estimates leave out.
constexpr double share_of_memory = 0.8;

SweepOutcome outcome_of(RunRecord const& record) {
  return {.has_begun = true,
          .status = record.status,
          .message = record.failure,
          .state_hash = record.state_hash,
          .seconds = record.seconds,
          .results = record.results};
}

/// A sweep being carried out.
class SweepInProgress {
 public:
  SweepInProgress(SweepPlan const& plan, SweepSettings const& settings)
      : plan_(plan),
        settings_(settings),
        directory_(plan, settings),
        memory_(share_of_memory * free_memory()),
        setup_(plan, settings, directory_, memory_),
        outcomes_(setup_.outcomes()) {}

  void run() {
    directory_.require_same_base();
    directory_.open();
    DirectoryLock const lock(settings_.directory, settings_.shard ? Sharing::with_others : Sharing::alone);
    directory_.forget_old_results();
    write_plan(plan_, settings_.directory);
    carry_out_all();
  }

  [[nodiscard]] std::vector<SweepOutcome> const& outcomes() const { return outcomes_; }
  [[nodiscard]] std::vector<std::string> notes() const { return setup_.notes(); }

 private:
  void carry_out_all() {
    std::vector<std::size_t> open;
    std::vector<double> work;
    std::size_t ours = 0;
    for (std::size_t run = 0; run < plan_.runs.size(); ++run) {
      if (directory_.is_ours(run)) ++ours;
      if (setup_.prospects()[run].work <= 0.0) continue;
      open.push_back(run);
      work.push_back(setup_.prospects()[run].work);
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

  SweepOutcome carry_out(std::size_t run, JobPool const& job_pool, std::function<bool(double)> const& report) {
    Prospect const& prospect = setup_.prospects()[run];
    RunHooks const hooks{.on_progress = [&](Progress const& progress) { return report(progress.fraction); },
                         .on_event = {},
                         .threads = prospect.threads};
    try {
      // Others that share the directory may have been faster.
      if (auto const summary = directory_.recorded(run); summary && is_finished(outcome_of(*summary))) {
        return outcome_of(*summary);
      }
      MemoryBudget::Part const memory(memory_, prospect.bytes);
      if (job_pool.is_stopped()) return outcomes_[run];
      if (directory_.is_there(run)) return outcome_of(resume_in(directory_.directory_of(run), hooks));
      SettingsFile settings = plan_.runs[run].settings;
      // What is recorded is what is used.
      if (prospect.takes_threads) settings.set(fmt::format("engine.threads={}", prospect.threads));
      return outcome_of(run_in(directory_.directory_of(run), set_up(settings), hooks));
    } catch (std::exception const& error) {
      return {.has_begun = true, .status = RunStatus::failed, .message = reason_of(error), .results = {}};
    }
  }

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  SweepDirectory directory_;
  MemoryBudget memory_;
  SweepSetup setup_;
  std::vector<SweepOutcome> outcomes_;
};

}  // namespace

SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings) {
  SweepInProgress sweep(plan, settings);
  sweep.run();
  SweepResult result = result_of(plan, sweep.outcomes());
  // Of a part of the sweep nothing is averaged.
  std::vector<std::string> notes = sweep.notes();
  if (!settings.shard) std::ranges::move(result.notes, std::back_inserter(notes));
  result.notes = std::move(notes);
  // The tables of a part would be taken for the whole: collect_sweep() makes them when all parts are there.
  if (!settings.shard) write_tables(result, settings.directory);
  return result;
}

}  // namespace gridlock
