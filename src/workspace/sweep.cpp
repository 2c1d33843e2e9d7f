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
#include "workspace/sweep_crew.hpp"
#include "workspace/sweep_directory.hpp"
#include "workspace/sweep_plan.hpp"
#include "workspace/sweep_setup.hpp"
#include "workspace/sweep_tables.hpp"
#include "workspace/sweep_worker.hpp"

namespace gridlock {

namespace {

/// Share of the free memory that a sweep uses; the rest is for memory that the estimates omit.
constexpr double share_of_memory = 0.8;

/// Returns the memory in bytes for a process; processes on a machine share its memory equally.
double memory_for(SweepSettings const& settings) {
  double const processes = settings.crew == nullptr ? 1.0 : static_cast<double>(settings.crew->processes_on_machine());
  return share_of_memory * free_memory() / processes;
}

MakeRun making(SweepWorker const& worker) {
  return [&worker](CrewJob const& job, ReportShare const& report) {
    auto const outcome = worker.make(job.run, job.prospect, report);
    return outcome ? encode(*outcome) : std::string();
  };
}

/// Carries out the runs that the leader assigns. Returns an empty result, since only the leader collects outcomes.
SweepResult help_with(SweepPlan const& plan, SweepSettings const& settings) {
  SweepDirectory const directory(plan, settings);
  MemoryBudget memory(memory_for(settings));
  SweepWorker const worker(plan, settings, directory, memory);
  settings.crew->meet(hash_of(plan), "");
  settings.crew->help(making(worker));
  return {};
}

/// A sweep that this process carries out or leads.
class SweepInProgress {
 public:
  SweepInProgress(SweepPlan const& plan, SweepSettings const& settings)
      : plan_(plan),
        settings_(settings),
        directory_(plan, settings),
        memory_(memory_for(settings)),
        setup_(plan, settings, directory_, memory_),
        worker_(plan, settings, directory_, memory_),
        outcomes_(setup_.outcomes()) {}

  void run() {
    directory_.require_same_base();
    directory_.open();
    DirectoryLock const lock(settings_.directory, settings_.shard ? Sharing::with_others : Sharing::alone);
    directory_.forget_old_results();
    write_plan(plan_, settings_.directory);
    if (settings_.crew != nullptr) settings_.crew->meet(hash_of(plan_), "");
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
    if (settings_.crew != nullptr) {
      carry_out_with(*settings_.crew, job_pool, open);
      return;
    }
    job_pool.run_all(settings_.threads, [&](std::size_t k) {
      std::size_t const run = open[k];
      auto outcome =
          worker_.make(run, setup_.prospects()[run], [&, k](double share) { return job_pool.report(k, share); });
      if (outcome) outcomes_[run] = std::move(*outcome);
    });
  }

  void carry_out_with(SweepCrew& crew, JobPool& job_pool, std::vector<std::size_t> const& open) {
    std::vector<std::size_t> job_of(plan_.runs.size(), 0);
    for (std::size_t k = 0; k < open.size(); ++k) job_of[open[k]] = k;
    crew.lead({.next = [&]() -> std::optional<CrewJob> {
                 auto const k = job_pool.take();
                 if (!k) return std::nullopt;
                 return CrewJob{.run = open[*k], .prospect = setup_.prospects()[open[*k]]};
               },
               .make = making(worker_),
               .report = [&](std::uint64_t run, double share) { return job_pool.report(job_of[run], share); },
               .finish =
                   [&](std::uint64_t run, std::string const& outcome) {
                     if (!outcome.empty()) outcomes_[run] = decode_outcome(outcome);
                     job_pool.finish(job_of[run]);
                   }});
  }

  SweepPlan const& plan_;
  SweepSettings const& settings_;
  SweepDirectory directory_;
  MemoryBudget memory_;
  SweepSetup setup_;
  SweepWorker worker_;
  std::vector<SweepOutcome> outcomes_;
};

}  // namespace

SweepResult run_sweep(SweepPlan const& plan, SweepSettings const& settings) {
  if (settings.crew != nullptr && !settings.crew->leads()) return help_with(plan, settings);
  SweepInProgress sweep(plan, settings);
  sweep.run();
  SweepResult result = result_of(plan, sweep.outcomes());
  // Notes on means are left out for a shard, which has only part of the runs.
  std::vector<std::string> notes = sweep.notes();
  if (!settings.shard) std::ranges::move(result.notes, std::back_inserter(notes));
  result.notes = std::move(notes);
  // A shard writes no tables, since they would look like the whole sweep's; collect_sweep() makes them from all shards.
  if (!settings.shard) write_tables(result, settings.directory);
  return result;
}

}  // namespace gridlock
