#include "gridlock/run/simulate.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <string>
#include <utility>

#include "engine/exact.hpp"

namespace gridlock {

namespace {

/// A step of 10⁶ agents takes a tenth of a second, one of a few a microsecond.
constexpr std::uint64_t model_steps_per_chunk = 8;

}  // namespace

DiskExperiment::DiskExperiment(Setup&& setup)
    : engine_settings_(setup.configuration.engine),
      state_(std::move(setup.state)),
      engine_(make_engine(engine_settings_, state_)),
      observables_(make_observables(setup.configuration.observe, {state_, tally_}, engine_settings_.kind != "exact")) {}

std::vector<Count> DiskExperiment::counts() const {
  std::vector<Count> counts{{"turns", tally_.turns},
                            {"blocked_turns", tally_.blocked_turns},
                            {"pair_collisions", tally_.pair_collisions},
                            {"wall_hits", tally_.all_wall_hits()},
                            {"distance_checks", tally_.distance_checks}};
  auto const* const exact = dynamic_cast<ExactEngine const*>(engine_.get());
  if (exact != nullptr && engine_settings_.audit_every > 0) {
    counts.push_back({"audits", exact->audits()});
    counts.push_back({"audits_for_missed_events", exact->audits_for_missed_events()});
  }
  return counts;
}

std::vector<ColumnInfo> DiskExperiment::columns() const {
  std::vector<ColumnInfo> columns;
  for (auto const& observable : observables_) std::ranges::move(observable->columns(), std::back_inserter(columns));
  return columns;
}

void DiskExperiment::sample(std::span<double> row, bool counts_for_average) {
  for (auto const& observable : observables_) {
    std::size_t const width = observable->columns().size();
    observable->sample({state_, tally_}, row.first(width), counts_for_average);
    row = row.subspan(width);
  }
}

std::vector<NamedEstimate> DiskExperiment::results() const {
  std::vector<NamedEstimate> results;
  for (auto const& observable : observables_) std::ranges::move(observable->results(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> DiskExperiment::distributions() const {
  std::vector<Distribution> distributions;
  for (auto const& observable : observables_) {
    std::ranges::move(observable->distributions(), std::back_inserter(distributions));
  }
  return distributions;
}

void DiskExperiment::carry(Archive& archive) {
  carry_inside(archive, "state", [&] { gridlock::carry(archive, state_); });
  // Made only to see whether an engine could work with it: a file can hold anything.
  if (archive.is_restoring()) static_cast<void>(make_engine(engine_settings_, state_));
  carry_inside(archive, "tally", [&] { gridlock::carry(archive, tally_); });
  carry_inside(archive, "engine", [&] { engine_->carry(archive, state_); });
  for (std::size_t k = 0; k < observables_.size(); ++k) {
    carry_inside(archive, "observable_" + std::to_string(k), [&] { observables_[k]->carry(archive); });
  }
}

std::unique_ptr<Experiment> make_experiment(Setup setup) {
  Configuration const& configuration = setup.configuration;
  if (!configuration.is_of_model()) return std::make_unique<DiskExperiment>(std::move(setup));
  return configuration.models.find(configuration.model.kind)
      ->make(setup.state.box, setup.state.seed,
             {.threads = configuration.engine.threads, .verify_every = configuration.model.verify_every});
}

RunPlan plan_of(Setup const& setup) {
  Configuration const& configuration = setup.configuration;
  RunPlan plan{.horizon = horizon_of(setup),
               .sample_every = configuration.observe.every,
               .discard = configuration.observe.discard};
  if (configuration.is_of_model()) plan.steps_per_chunk = model_steps_per_chunk;
  return plan;
}

RunResult simulate(Setup setup, OnProgress const& on_progress) {
  RunPlan const plan = plan_of(setup);
  DiskExperiment experiment(std::move(setup));
  Run run(experiment, plan);
  run.go_on(on_progress);
  return {run.record(), experiment.state(), experiment.tally()};
}

}  // namespace gridlock
