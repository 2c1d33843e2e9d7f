#include "gridlock/simulation/simulate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "engine/exact.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

/// A step of 10⁶ agents takes a tenth of a second, one of a few a microsecond.
constexpr std::uint64_t model_steps_per_chunk = 8;

/// How long a run that only collisions can end waits for the next one before it gives up.
///
/// In a gas of as many disks of the smallest size, a disk of the typical speed v meets another after about
/// t = A / (N σ v). Ten thousand times that is far beyond chance for many disks and a million times for two, which pass
/// each other now and then for long; yet it is soon over in a computer. Velocities count from their mean in a periodic
/// box, where disks that all move alike never meet.
double patience(RunSettings const& run, State const& state) {
  if (run.steps || run.time || !run.collisions_per_disk) return std::numeric_limits<double>::infinity();
  double const disks = static_cast<double>(state.disks.size());
  Vector mean{};
  if (state.box.is_periodic()) {
    for (std::size_t i = 0; i < state.disks.size(); ++i) mean = mean + velocity(state.disks, i);
    mean = (1.0 / disks) * mean;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < state.disks.size(); ++i) squares += squared_length(velocity(state.disks, i) - mean);
  double const speed = std::sqrt(squares / disks);
  double const mean_free_time = state.box.area() / (disks * 2.0 * radius_range(state.disks).smallest * speed);
  return (1e4 + 4e6 / (disks * disks)) * mean_free_time;
}

}  // namespace

DiskSimulation::DiskSimulation(Setup&& setup)
    : engine_settings_(setup.configuration.engine),
      state_(std::move(setup.state)),
      engine_(make_engine(engine_settings_, state_)),
      observables_(
          make_observables(setup.configuration.observe, {state_, counters_}, engine_settings_.kind != "exact")),
      patience_(patience(setup.configuration.run, state_)) {}

void DiskSimulation::advance(StopCondition const& stop_condition) {
  if (!std::isfinite(patience_)) {
    engine_->advance(state_, counters_, stop_condition);
    return;
  }
  bool is_patient = true;
  StopCondition watched = stop_condition;
  watched.should_continue = [&] {
    if (!last_collision_ || counters_.pair_collisions != collisions_seen_) {
      last_collision_ = state_.clock.time;
      collisions_seen_ = counters_.pair_collisions;
    }
    is_patient = state_.clock.time - *last_collision_ <= patience_;
    return is_patient && !stop_condition.stops_here();
  };
  engine_->advance(state_, counters_, watched);
  if (is_patient) return;
  throw RunFailure(
      fmt::format("no two disks have met for a time of {:.6g}, in which disks that move at random meet again "
                  "and again: these never will, and collisions alone end this run\n"
                  "  hint: give run.steps or run.time as well",
                  patience_));
}

std::vector<Count> DiskSimulation::counts() const {
  std::vector<Count> counts{{"moves", counters_.moves},
                            {"halted_moves", counters_.halted_moves},
                            {"pair_collisions", counters_.pair_collisions},
                            {"wall_hits", counters_.all_wall_hits()},
                            {"distance_checks", counters_.distance_checks}};
  auto const* const exact = dynamic_cast<ExactEngine const*>(engine_.get());
  if (exact != nullptr && engine_settings_.audit_every > 0) {
    counts.push_back({"audits", exact->audits()});
    counts.push_back({"audits_for_missed_events", exact->audits_for_missed_events()});
  }
  return counts;
}

std::vector<ColumnInfo> DiskSimulation::columns() const {
  std::vector<ColumnInfo> columns;
  for (auto const& observable : observables_) std::ranges::move(observable->columns(), std::back_inserter(columns));
  return columns;
}

void DiskSimulation::sample(std::span<double> row, bool counts_for_average) {
  for (auto const& observable : observables_) {
    std::size_t const width = observable->columns().size();
    observable->sample({state_, counters_}, row.first(width), counts_for_average);
    row = row.subspan(width);
  }
}

std::vector<NamedEstimate> DiskSimulation::results() const {
  std::vector<NamedEstimate> results;
  for (auto const& observable : observables_) std::ranges::move(observable->results(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> DiskSimulation::distributions() const {
  std::vector<Distribution> distributions;
  for (auto const& observable : observables_) {
    std::ranges::move(observable->distributions(), std::back_inserter(distributions));
  }
  return distributions;
}

void DiskSimulation::serialize(Archive& archive) {
  serialize_inside(archive, "state", [&] { gridlock::serialize(archive, state_); });
  // Made only to see whether an engine could work with it: a file can hold anything.
  if (archive.is_restoring()) static_cast<void>(make_engine(engine_settings_, state_));
  serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
  serialize_inside(archive, "engine", [&] { engine_->serialize(archive, state_); });
  for (std::size_t k = 0; k < observables_.size(); ++k) {
    serialize_inside(archive, "observable_" + std::to_string(k), [&] { observables_[k]->serialize(archive); });
  }
}

std::unique_ptr<Simulation> make_simulation(Setup&& setup) {
  Configuration const& configuration = setup.configuration;
  if (!configuration.is_of_model()) return std::make_unique<DiskSimulation>(std::move(setup));
  return configuration.models.find(configuration.model.kind)
      ->make(setup.state.box, setup.state.seed,
             {.threads = configuration.engine.threads, .verify_every = configuration.model.verify_every});
}

RunPlan plan_of(Setup const& setup) {
  Configuration const& configuration = setup.configuration;
  RunPlan plan{.stop_condition = stop_condition_of(setup),
               .sample_every = configuration.observe.every,
               .equilibration = configuration.observe.equilibration};
  if (configuration.is_of_model()) plan.steps_per_chunk = model_steps_per_chunk;
  return plan;
}

RunResult simulate(Setup setup, OnProgress const& on_progress) {
  RunPlan const plan = plan_of(setup);
  DiskSimulation simulation(std::move(setup));
  Run run(simulation, plan);
  run.go_on(on_progress);
  return {run.record(), simulation.state(), simulation.counters()};
}

}  // namespace gridlock
