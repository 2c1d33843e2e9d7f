#include "simulation/protocol_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "gridlock/core/error.hpp"

namespace gridlock {

namespace {

std::optional<double> as_number(std::optional<bool> flag) {
  return flag ? std::optional(*flag ? 1.0 : 0.0) : std::nullopt;
}

/// What the last stage that knows it says.
void add_last(std::vector<NamedEstimate>& results, std::vector<StageResult> const& stages, std::string name,
              auto value_of, auto error_of) {
  for (auto stage = stages.rbegin(); stage != stages.rend(); ++stage) {
    std::optional<double> const value = value_of(*stage);
    if (!value) continue;
    results.push_back({std::move(name), {.value = *value, .error = error_of(*stage)}, ""});
    return;
  }
}

std::vector<NamedEstimate> estimates_of(std::vector<StageResult> const& stages) {
  std::vector<NamedEstimate> results;
  auto const no_error = [](StageResult const&) { return std::optional<double>(); };
  add_last(
      results, stages, "jamming_packing_fraction",
      [](StageResult const& stage) { return stage.jamming_packing_fraction; },
      [](StageResult const& stage) { return stage.error_of_jamming_packing_fraction; });
  auto const of_soft = [](auto member) {
    return [member](StageResult const& stage) { return leaves_overlaps(stage.kind) ? stage.*member : std::nullopt; };
  };
  add_last(results, stages, "soft_pressure", of_soft(&StageResult::pressure), no_error);
  add_last(results, stages, "soft_energy", of_soft(&StageResult::energy), no_error);
  add_last(results, stages, "residual_force", of_soft(&StageResult::residual), no_error);
  add_last(
      results, stages, "is_converged", [](StageResult const& stage) { return as_number(stage.is_converged); },
      no_error);
  return results;
}

Distribution stages_table(std::vector<StageResult> const& stages) {
  Distribution table{.name = "stages",
                     .columns = {{"stage", "", "The number of the stage, from 1."},
                                 {"packing_fraction", "", "At its end."},
                                 {"pressure", "", "βP/ρ of hard disks, P D²/ε of soft ones."},
                                 {"energy", "", "Of all soft disks, in ε."},
                                 {"residual", "", "Largest net force over the mean contact force."},
                                 {"jamming_packing_fraction", "", "Where the pressure vanishes."},
                                 {"work", "", "Iterations, events or trial moves."}},
                     .columns_of_values = std::vector<std::vector<double>>(7)};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageResult const& stage = stages[k];
    double const row[] = {static_cast<double>(k + 1),        stage.packing_fraction,
                          stage.pressure.value_or(no_value), stage.energy.value_or(no_value),
                          stage.residual.value_or(no_value), stage.jamming_packing_fraction.value_or(no_value),
                          static_cast<double>(stage.work)};
    for (std::size_t c = 0; c < std::size(row); ++c) table.columns_of_values[c].push_back(row[c]);
  }
  return table;
}

Distribution levels_table(std::vector<StageResult> const& stages) {
  Distribution table{
      .name = "levels",
      .columns = {{"stage", "", "The number of the stage, from 1."},
                  {"packing_fraction", "", "Of the minimum."},
                  {"pressure", "", "P D²/ε."},
                  {"energy", "", "Of all disks, in ε."},
                  {"residual", "", "Largest net force over the mean contact force."},
                  {"iterations", "", "Of FIRE and Newton since the level before."},
                  {"jamming_packing_fraction", "", "Where the pressure vanishes, from the last two minima."}},
      .columns_of_values = std::vector<std::vector<double>>(7)};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    for (PressureLevel const& level : stages[k].levels) {
      double const row[] = {static_cast<double>(k + 1),
                            level.packing_fraction,
                            level.pressure,
                            level.energy,
                            level.residual,
                            static_cast<double>(level.iterations),
                            level.jamming_packing_fraction};
      for (std::size_t c = 0; c < std::size(row); ++c) table.columns_of_values[c].push_back(row[c]);
    }
  }
  return table;
}

}  // namespace

ProtocolSimulation::ProtocolSimulation(ProtocolSettings const& settings, State start, MakeSimulation make)
    : make_(std::move(make)),
      start_clock_(start.clock),
      state_(std::move(start)),
      protocol_(settings, state_),
      simulation_(make_(state_, false)) {}

bool ProtocolSimulation::prepare(std::function<bool()> const& should_continue) {
  if (is_prepared_) return true;
  if (!protocol_.advance(state_, should_continue)) return false;
  begin_simulation();
  return true;
}

void ProtocolSimulation::begin_simulation() {
  state_.clock = start_clock_;
  try {
    simulation_ = make_(state_, true);
  } catch (Error const& error) {
    throw RunFailure("the run after the protocol cannot begin: " + to_text(error.problems().front()));
  }
  is_prepared_ = true;
}

Preparation ProtocolSimulation::preparation() const {
  if (is_prepared_) return {};
  return {.fraction = static_cast<double>(protocol_.stage()) / static_cast<double>(protocol_.stages()),
          .what = protocol_.name_of_stage(),
          .work = protocol_.work()};
}

AgentsView ProtocolSimulation::view() const { return is_prepared_ ? simulation_->view() : AgentsView(state_.agents); }

std::uint64_t ProtocolSimulation::state_hash() const { return is_prepared_ ? simulation_->state_hash() : hash(state_); }

std::vector<NamedColumn> ProtocolSimulation::columns_of_agents() {
  return is_prepared_ ? simulation_->columns_of_agents() : columns_of(state_.agents);
}

std::shared_ptr<void> ProtocolSimulation::release_columns() {
  return is_prepared_ ? simulation_->release_columns() : state_.agents.release();
}

void ProtocolSimulation::require_valid() const {
  if (is_prepared_) simulation_->require_valid();
}

std::vector<NamedEstimate> ProtocolSimulation::results() const {
  std::vector<NamedEstimate> results = estimates_of(protocol_.results());
  if (is_prepared_) std::ranges::move(simulation_->results(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> ProtocolSimulation::distributions() const {
  std::vector<Distribution> distributions;
  if (is_prepared_) distributions = simulation_->distributions();
  if (protocol_.results().empty()) return distributions;
  distributions.push_back(stages_table(protocol_.results()));
  Distribution levels = levels_table(protocol_.results());
  if (!levels.columns_of_values.front().empty()) distributions.push_back(std::move(levels));
  return distributions;
}

Frame ProtocolSimulation::frame() const { return is_prepared_ ? simulation_->frame() : frame_of(state_); }

void ProtocolSimulation::serialize(Archive& archive) {
  archive.visit("is_prepared", is_prepared_);
  serialize_inside(archive, "start_clock", [&] { gridlock::serialize(archive, start_clock_); });
  serialize_inside(archive, "state", [&] { gridlock::serialize(archive, state_); });
  serialize_inside(archive, "protocol", [&] { protocol_.serialize(archive, state_); });
  if (!is_prepared_) return;
  // The state is still the one with which the simulation began.
  if (archive.is_restoring()) begin_simulation();
  serialize_inside(archive, "simulation", [&] { simulation_->serialize(archive); });
}

}  // namespace gridlock
