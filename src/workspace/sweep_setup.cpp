#include "workspace/sweep_setup.hpp"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <functional>
#include <new>
#include <utility>

#include "simulation/check.hpp"
#include "simulation/expected_work.hpp"
#include "workspace/job_pool.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock {

SweepSetup::SweepSetup(SweepPlan const& plan, SweepSettings const& settings, SweepDirectory const& directory,
                       MemoryBudget& memory)
    : plan_(plan),
      settings_(settings),
      directory_(directory),
      memory_(memory),
      outcomes_(plan.runs.size()),
      errors_(plan.runs.size()),
      prospects_(plan.runs.size()),
      notes_(plan.runs.size()) {
  set_up_all();
  require_one_good();
  share_out_threads();
}

std::vector<std::string> SweepSetup::notes() const {
  std::vector<std::vector<Event>> notes;
  for (auto const& run : notes_) {
    if (run) notes.push_back(*run);
  }
  return texts_of(notes);
}

void SweepSetup::set_up_all() {
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
  // A run that lacked memory beside others may fit alone.
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

/// Sets up a run to estimate its work. Throws std::bad_alloc; any other failure is stored.
void SweepSetup::look_at(std::size_t run) {
  try {
    Configuration configuration;
    plan_.runs[run].settings.read_into(describing(configuration));
    MemoryBudget::Part const memory(memory_, expected_memory(configuration));
    // This set-up is only examined, so one thread suffices.
    Setup const setup = set_up(plan_.runs[run].settings, {.threads = 1});
    require_shareable(run, setup.configuration);
    notes_[run] = setup.notes;
    if (auto refusal = directory_.refusal_of(run, setup)) {
      std::scoped_lock const guard(mutex_);
      is_in_the_way_ = std::move(refusal);
    }
    if (!directory_.is_ours(run)) return;
    // The tables list the recorded result of a run that this call does not carry out.
    if (auto const summary = directory_.recorded(run)) outcomes_[run] = outcome_of(*summary);
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

void SweepSetup::require_shareable(std::size_t run, Configuration const& configuration) const {
  if (settings_.crew == nullptr) return;
  try {
    gridlock::require_shareable(configuration, settings_.crew->processes_of_run());
  } catch (Error const& error) {
    throw plan_.runs[run].settings.locate(error);
  }
}

void SweepSetup::note_failure(std::size_t run, std::exception const& error) {
  outcomes_[run] = {.has_begun = false, .status = RunStatus::failed, .message = reason_of(error), .results = {}};
}

/// Throws the first Error if every run has one, since the mistake is then in the user's input.
void SweepSetup::require_one_good() const {
  bool const are_all_mistaken = std::ranges::all_of(errors_, [](auto const& error) { return error.has_value(); });
  if (are_all_mistaken) throw *errors_.front();
}

/// Distributes free cores among the runs that use several threads; the longest runs get the most.
void SweepSetup::share_out_threads() {
  std::vector<std::size_t> takers;
  auto left = static_cast<std::uint64_t>(jobs_for(settings_.threads));
  for (std::size_t run = 0; run < prospects_.size(); ++run) {
    if (prospects_[run].work > 0.0) left -= std::min(left, prospects_[run].threads);
    if (prospects_[run].takes_threads) takers.push_back(run);
  }
  // With other processes on the machine, the memory for more threads is unknown.
  if (takers.empty() || settings_.crew != nullptr) return;
  std::ranges::stable_sort(takers, std::ranges::greater{}, [&](std::size_t run) { return prospects_[run].work; });
  for (std::size_t k = 0; k < takers.size(); ++k) {
    prospects_[takers[k]].threads += left / takers.size() + (k < left % takers.size() ? 1 : 0);
  }
}

bool is_finished(SweepOutcome const& outcome) { return outcome.has_begun && outcome.status == RunStatus::finished; }

std::string reason_of(std::exception const& error) {
  return dynamic_cast<std::bad_alloc const*>(&error) == nullptr ? error.what() : "not enough memory";
}

}  // namespace gridlock
