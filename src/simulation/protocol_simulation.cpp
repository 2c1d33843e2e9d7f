#include "simulation/protocol_simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/packing/contact_network.hpp"

namespace gridlock {

namespace {

void add_if_known(std::vector<NamedEstimate>& results, char const* name, std::optional<double> value,
                  std::optional<double> error = {}) {
  if (value && std::isfinite(*value)) results.push_back({name, {.value = *value, .error = error}, ""});
}

/// Of the last stage of swap Monte Carlo.
void add_swap(std::vector<StageResult> const& stages, std::vector<NamedEstimate>& results) {
  auto const last = std::ranges::find_if(stages.rbegin(), stages.rend(),
                                         [](StageResult const& stage) { return stage.swap.has_value(); });
  if (last == stages.rend()) return;
  SwapResult const& swap = *last->swap;
  add_if_known(results, "displacement_acceptance", swap.displacement_acceptance);
  add_if_known(results, "swap_acceptance", swap.swap_acceptance);
  add_if_known(results, "overlap_relaxation_time", swap.overlap_relaxation_time);
  add_if_known(results, "bond_relaxation_time", swap.bond_relaxation_time);
  add_if_known(results, "relaxation_times", swap.relaxation_times);
  add_if_known(results, "is_equilibrated", swap.is_equilibrated ? 1.0 : 0.0);
}

/// The decay of the correlations in all stages of swap Monte Carlo.
Distribution swap_table(std::vector<StageResult> const& stages) {
  Distribution table{.name = "swap_correlations",
                     .columns = {{"stage", "", "The number of the stage, from 1."},
                                 {"lag", "sweeps", "Between two times."},
                                 {"self_overlap", "", "Share of disks in the cage they were in."},
                                 {"bond_orientation", "", "Correlation of the local hexatic order."}},
                     .columns_of_values = std::vector<std::vector<double>>(4)};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    if (!stages[k].swap) continue;
    SwapResult const& swap = *stages[k].swap;
    for (std::size_t i = 0; i < swap.lags.size(); ++i) {
      double const row[] = {static_cast<double>(k + 1), swap.lags[i], swap.self_overlap[i], swap.bond_orientation[i]};
      for (std::size_t c = 0; c < std::size(row); ++c) table.columns_of_values[c].push_back(row[c]);
    }
  }
  return table;
}

std::vector<NamedEstimate> estimates_of(std::vector<StageResult> const& stages) {
  std::vector<NamedEstimate> results;
  add_swap(stages, results);
  auto const last_soft = std::ranges::find_if(stages.rbegin(), stages.rend(),
                                              [](StageResult const& stage) { return !stage.levels.empty(); });
  if (last_soft == stages.rend()) return results;
  PressureLevel const& level = last_soft->levels.back();
  auto const add = [&](char const* name, std::optional<double> value, std::optional<double> error = {}) {
    add_if_known(results, name, value, error);
  };
  double const rattlers = last_soft->disks - static_cast<double>(level.backbone_disks);
  bool const is_converged = last_soft->is_converged.value_or(false);
  add("jamming_packing_fraction", last_soft->jamming_packing_fraction, last_soft->error_of_jamming_packing_fraction);
  add("pressure", level.pressure);
  add("energy_per_disk", last_soft->disks > 0.0 ? level.energy / last_soft->disks : 0.0);
  add("contact_number", level.contact_number);
  add("backbone_disks", static_cast<double>(level.backbone_disks));
  add("rattler_share", last_soft->disks > 0.0 ? rattlers / last_soft->disks : 0.0);
  add("excess_contacts", level.excess_contacts);
  add("bulk_modulus", level.bulk_modulus);
  add("shear_modulus", level.shear_modulus);
  add("least_shear_modulus", level.least_shear_modulus);
  add("softest_mode", last_soft->softest_mode);
  add("residual_force", level.residual);
  add("is_converged", is_converged ? 1.0 : 0.0);
  add("is_jammed", last_soft->is_jammed.value_or(false) ? 1.0 : 0.0);
  add("is_shear_stable", level.least_shear_modulus > 0.0 ? 1.0 : 0.0);
  return results;
}

Distribution stages_table(std::vector<StageResult> const& stages) {
  Distribution table{.name = "stages",
                     .columns = {{"stage", "", "The number of the stage, from 1."},
                                 {"packing_fraction", "", "At its end."},
                                 {"pressure", "", "βP/ρ of hard disks, P D²/ε of soft ones."},
                                 {"jamming_packing_fraction", "", "Where the pressure vanishes."},
                                 {"work", "", "Iterations, events or trial moves."}},
                     .columns_of_values = std::vector<std::vector<double>>(5)};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageResult const& stage = stages[k];
    double const row[] = {static_cast<double>(k + 1), stage.packing_fraction, stage.pressure.value_or(no_value),
                          stage.jamming_packing_fraction.value_or(no_value), static_cast<double>(stage.work)};
    for (std::size_t c = 0; c < std::size(row); ++c) table.columns_of_values[c].push_back(row[c]);
  }
  return table;
}

/// A column of levels.csv.
struct LevelColumn {
  ColumnInfo info;
  std::function<double(PressureLevel const&)> value_of;
};

std::vector<LevelColumn> level_columns() {
  auto const count = [](std::uint64_t PressureLevel::*member) {
    return [member](PressureLevel const& level) { return static_cast<double>(level.*member); };
  };
  return {
      {{"packing_fraction", "", "Of the minimum."}, &PressureLevel::packing_fraction},
      {{"pressure", "", "P D²/ε."}, &PressureLevel::pressure},
      {{"energy", "", "Of all disks, in ε."}, &PressureLevel::energy},
      {{"contact_number", "", "Contacts of a disk of the backbone."}, &PressureLevel::contact_number},
      {{"backbone_disks", "", "Disks that are no rattlers."}, count(&PressureLevel::backbone_disks)},
      {{"excess_contacts", "", "Contacts beyond those that a marginal packing has."}, &PressureLevel::excess_contacts},
      {{"bulk_modulus", "", "In ε/D²."}, &PressureLevel::bulk_modulus},
      {{"shear_modulus", "", "Mean over all directions, in ε/D²."}, &PressureLevel::shear_modulus},
      {{"least_shear_modulus", "", "Of the softest direction, in ε/D²."}, &PressureLevel::least_shear_modulus},
      {{"residual", "", "Largest net force over the mean contact force."}, &PressureLevel::residual},
      {{"iterations", "", "Of the minimizer since the level before."}, count(&PressureLevel::iterations)},
      {{"jamming_packing_fraction", "", "Where the pressure vanishes, from the last two minima."},
       &PressureLevel::jamming_packing_fraction}};
}

Distribution levels_table(std::vector<StageResult> const& stages) {
  std::vector<LevelColumn> const columns = level_columns();
  Distribution table{
      .name = "levels", .columns = {{"stage", "", "The number of the stage, from 1."}}, .columns_of_values = {}};
  for (LevelColumn const& column : columns) table.columns.push_back(column.info);
  table.columns_of_values.resize(table.columns.size());
  for (std::size_t k = 0; k < stages.size(); ++k) {
    for (PressureLevel const& level : stages[k].levels) {
      table.columns_of_values[0].push_back(static_cast<double>(k + 1));
      for (std::size_t c = 0; c < columns.size(); ++c)
        table.columns_of_values[c + 1].push_back(columns[c].value_of(level));
    }
  }
  return table;
}

/// A note on the stage of that number, from 0.
Event note_on(EventKind kind, StageResult const& stage, std::size_t number) {
  return {.kind = kind,
          .key = "protocol",
          .values = {{"stage", static_cast<std::uint64_t>(number + 1)},
                     {"name", std::string(name_of(stage.kind))},
                     {"packing_fraction", stage.packing_fraction}}};
}

/// Of swap Monte Carlo, and of the end of a ramp or quench.
std::optional<Event> note_on_end(StageResult const& stage, std::size_t number) {
  if (stage.swap && !stage.swap->is_equilibrated) {
    Event note = note_on(EventKind::stage_not_equilibrated, stage, number);
    std::optional<double> const times = stage.swap->relaxation_times;
    if (times && std::isfinite(*times)) note.values.emplace_back("relaxation_times", *times);
    return note;
  }
  if (stage.levels.empty()) return std::nullopt;
  double const pressure = stage.levels.back().pressure;
  if (!(pressure > 0.0)) return note_on(EventKind::stage_without_pressure, stage, number);
  if (stage.is_converged.value_or(true)) return std::nullopt;
  Event note = note_on(EventKind::stage_fell_short, stage, number);
  note.values.emplace_back("pressure", pressure);
  return note;
}

/// Disks that press and are not jammed: their jamming packing fraction is not that of a packing.
std::optional<Event> note_on_unjammed(StageResult const& stage, std::size_t number) {
  PressureLevel const& level = stage.levels.back();
  if (stage.is_jammed.value_or(true) || !(level.pressure > 0.0)) return std::nullopt;
  Event note = note_on(EventKind::packing_not_jammed, stage, number);
  if (level.backbone_disks == 0 || level.excess_contacts < 0.0) {
    note.values.emplace_back("backbone_disks", level.backbone_disks);
    note.values.emplace_back("missing_contacts", static_cast<std::uint64_t>(-std::min(level.excess_contacts, 0.0)));
  } else if (stage.softest_mode) {
    note.values.emplace_back("softest_mode", *stage.softest_mode);
  }
  note.values.emplace_back("residual", level.residual);
  if (stage.jamming_packing_fraction)
    note.values.emplace_back("jamming_packing_fraction", *stage.jamming_packing_fraction);
  return note;
}

/// A shear that costs nothing. In a periodic packing with one state of self-stress there is always one.
std::optional<Event> note_on_shear(StageResult const& stage, std::size_t number, bool is_periodic) {
  PressureLevel const& level = stage.levels.back();
  // No number where no disks press.
  if (!(level.least_shear_modulus <= 0.0) || (is_periodic && level.excess_contacts <= 0.0)) return std::nullopt;
  Event note = note_on(EventKind::packing_unstable, stage, number);
  note.values.emplace_back("least_shear_modulus", level.least_shear_modulus);
  return note;
}

std::vector<Event> notes_on(std::vector<StageResult> const& stages, bool is_periodic) {
  std::vector<Event> notes;
  std::optional<std::size_t> last_soft;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    if (!stages[k].levels.empty()) last_soft = k;
  }
  for (std::size_t k = 0; k < stages.size(); ++k) {
    // A quench below jamming may be the start of a compression.
    if (stages[k].kind == StageKind::quench && k != last_soft) continue;
    if (auto note = note_on_end(stages[k], k)) notes.push_back(*std::move(note));
  }
  if (!last_soft) return notes;
  if (auto note = note_on_unjammed(stages[*last_soft], *last_soft)) notes.push_back(*std::move(note));
  if (auto note = note_on_shear(stages[*last_soft], *last_soft, is_periodic)) notes.push_back(*std::move(note));
  return notes;
}

}  // namespace

ProtocolSimulation::ProtocolSimulation(ProtocolSettings const& settings, State start, MakeSimulation make)
    : make_(std::move(make)),
      soft_(settings.soft),
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
  return {.fraction = static_cast<double>(protocol_.stage()) / static_cast<double>(protocol_.stages()),
          .what = protocol_.name_of_stage(),
          .work = protocol_.work(),
          .stages = protocol_.stages(),
          .finished = protocol_.stage()};
}

std::vector<Event> ProtocolSimulation::notes() const { return notes_on(protocol_.results(), state_.box.is_periodic()); }

/// Before its first step a run has measured nothing.
bool ProtocolSimulation::has_run() const { return is_prepared_ && simulation_->clock() != start_clock_; }

void ProtocolSimulation::observe(std::unique_ptr<Observable> observable) {
  if (!is_prepared_) {
    throw Error({.what = "an observable cannot be added before the protocol has ended",
                 .hint = "carry out the protocol alone, and start the run from the state that it leaves",
                 .key = "protocol"});
  }
  simulation_->observe(std::move(observable));
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
  if (has_run()) std::ranges::move(simulation_->results(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> ProtocolSimulation::distributions() const {
  std::vector<Distribution> distributions;
  if (has_run()) distributions = simulation_->distributions();
  if (protocol_.results().empty()) return distributions;
  distributions.push_back(stages_table(protocol_.results()));
  std::array tables{levels_table(protocol_.results()), swap_table(protocol_.results())};
  for (Distribution& table : tables) {
    if (!table.columns_of_values.front().empty()) distributions.push_back(std::move(table));
  }
  return distributions;
}

Frame ProtocolSimulation::frame() const { return is_prepared_ ? simulation_->frame() : frame_of(state_); }

std::optional<FrameContacts> ProtocolSimulation::contacts() const {
  if (!is_prepared_ || has_run() || protocol_.results().empty() || protocol_.results().back().levels.empty()) {
    return std::nullopt;
  }
  ContactNetwork const network = find_contact_network(packing_of(state_), soft_.potential);
  if (!network.is_converged(soft_.residual)) return std::nullopt;
  std::vector<Id> ids(state_.agents.ids().begin(), state_.agents.ids().end());
  std::ranges::sort(ids);
  FrameContacts contacts{.clock = start_clock_, .ids = {}, .forces = {}};
  for (std::size_t k = 0; k < network.contacts.size(); ++k) {
    Contact const& contact = network.contacts[k];
    bool const is_at_wall = contact.second >= ids.size();
    if (is_at_wall) continue;
    contacts.ids.insert(contacts.ids.end(), {ids[contact.first], ids[contact.second]});
    contacts.forces.push_back(network.forces[k]);
  }
  return contacts;
}

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
