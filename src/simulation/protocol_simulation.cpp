#include "simulation/protocol_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "protocol/stage.hpp"
#include "simulation/packing_analysis.hpp"
#include "simulation/protocol_tables.hpp"

namespace gridlock {

namespace {

/// A value of summary.json that a stage of the protocol provides.
struct ResultEntry {
  ColumnInfo info;
  std::function<std::optional<double>(StageResult const&)> value_of;
  std::function<std::optional<double>(StageResult const&)> error_of = {};
};

double number(bool flag) { return flag ? 1.0 : 0.0; }

/// Returns the results of the last stage if its disks are hard.
std::vector<ResultEntry> hard_entries() {
  return {
      {{"reduced_pressure", "", "βP/ρ of the hard disks in the last stage of the protocol."}, &StageResult::pressure}};
}

/// Returns whether the packing is unstable against compression; false if its bulk modulus is NaN.
bool gives_way(PressureLevel const& level) { return level.bulk_modulus <= 0.0; }

/// Returns the results of the last stage of soft disks.
std::vector<ResultEntry> soft_entries() {
  auto const end = [](auto member) {
    return [member](StageResult const& stage) { return std::invoke(member, stage.levels.back()); };
  };
  // Moduli at an instability are left out, since arbitrary values would spoil means over runs.
  auto const modulus = [](auto member) {
    return [member](StageResult const& stage) {
      PressureLevel const& level = stage.levels.back();
      return gives_way(level) ? std::nullopt : std::optional(std::invoke(member, level));
    };
  };
  auto const share = [](double part, double disks) { return disks > 0.0 ? part / disks : 0.0; };
  return {
      {{"jamming_packing_fraction", "", "Where the pressure of the last two minima vanishes."},
       &StageResult::jamming_packing_fraction,
       &StageResult::error_of_jamming_packing_fraction},
      {{"pressure", "", "P D²/ε of the packing, D the diameter of the smallest disk."}, end(&PressureLevel::pressure)},
      {{"energy_per_disk", "", "In ε."},
       [=](StageResult const& stage) { return share(stage.levels.back().energy, stage.disks); }},
      {{"contact_number", "", "Z = 2 N_c/N₀ of the backbone."}, end(&PressureLevel::contact_number)},
      {{"backbone_disks", "", "N₀, disks that are no rattlers."}, end(&PressureLevel::backbone_disks)},
      {{"rattler_share", "", "Disks with fewer than three contacts of the backbone, over all disks."},
       [=](StageResult const& stage) {
         return share(stage.disks - static_cast<double>(stage.levels.back().backbone_disks), stage.disks);
       }},
      {{"excess_contacts", "", "Contacts of the backbone beyond those that a marginal packing has."},
       end(&PressureLevel::excess_contacts)},
      {{"bulk_modulus", "", "K in ε/D²."}, modulus(&PressureLevel::bulk_modulus)},
      {{"shear_modulus", "", "⟨G⟩, the mean over all directions, in ε/D²."}, modulus(&PressureLevel::shear_modulus)},
      {{"simple_shear_modulus", "", "dσ/dγ of x ← x + γ y, in ε/D²."}, modulus(&PressureLevel::simple_shear_modulus)},
      {{"pure_shear_modulus", "", "dσ/dγ of x ← x e^(γ/2), y ← y e^(−γ/2), in ε/D²."},
       modulus(&PressureLevel::pure_shear_modulus)},
      {{"least_shear_modulus", "", "G of the softest direction, in ε/D²."},
       modulus(&PressureLevel::least_shear_modulus)},
      {{"softest_mode", "", "The smallest eigenvalue of the Hessian of the backbone, in ε/D²."},
       &StageResult::softest_mode},
      {{"residual_force", "", "The largest net force over the mean contact force."}, end(&PressureLevel::residual)},
      {{"is_converged", "", "1 where the stage reached its end at a minimum, else 0."},
       [](StageResult const& stage) { return number(stage.is_converged.value_or(false)); }},
      {{"is_jammed", "", "1 where forces balance, with pressure and enough contacts and no way down, else 0."},
       [](StageResult const& stage) { return number(stage.is_jammed.value_or(false)); }},
      {{"is_shear_stable", "", "1 where least_shear_modulus is above 0, else 0."},
       [](StageResult const& stage) { return number(stage.levels.back().least_shear_modulus > 0.0); }},
      {{"is_compression_stable", "", "1 where a smaller box costs energy, else 0; its moduli are left out then."},
       [](StageResult const& stage) -> std::optional<double> {
         PressureLevel const& level = stage.levels.back();
         return std::isnan(level.bulk_modulus) ? std::nullopt : std::optional(number(!gives_way(level)));
       }}};
}

void add_results(std::vector<ResultEntry> const& entries, StageResult const& stage,
                 std::vector<NamedEstimate>& results) {
  for (ResultEntry const& entry : entries) {
    std::optional<double> const value = entry.value_of(stage);
    if (!value || !std::isfinite(*value)) continue;
    std::optional<double> const error = entry.error_of ? entry.error_of(stage) : std::nullopt;
    results.push_back({entry.info.name, {.value = *value, .error = error}, ""});
  }
}

bool is_soft(StageResult const& stage) { return !stage.levels.empty(); }

std::vector<NamedEstimate> estimates_of(std::vector<StageResult> const& stages) {
  std::vector<NamedEstimate> results;
  if (stages.empty()) return results;
  if (!is_soft(stages.back())) add_results(hard_entries(), stages.back(), results);
  std::ranges::move(swap_results(stages), std::back_inserter(results));
  auto const soft = std::find_if(stages.rbegin(), stages.rend(), is_soft);
  if (soft != stages.rend()) add_results(soft_entries(), *soft, results);
  auto const shear =
      std::find_if(stages.rbegin(), stages.rend(), [](auto const& stage) { return stage.shear.has_value(); });
  if (shear != stages.rend()) std::ranges::move(shear_results(*shear->shear), std::back_inserter(results));
  return results;
}

Distribution stages_table(std::vector<StageResult> const& stages) {
  Distribution table{
      .name = "stages",
      .columns = {{.name = "stage", .documentation = "The number of the stage, from 1.", .is_count = true},
                  {"packing_fraction", "", "At its end."},
                  {"pressure", "", "βP/ρ of hard disks, P D²/ε of soft ones."},
                  {"jamming_packing_fraction", "", "Where the pressure vanishes."},
                  {.name = "pair_collisions", .documentation = "Of hard disks that fly.", .is_count = true},
                  {.name = "work", .documentation = "Iterations, events or trial moves.", .is_count = true}},
      .columns_of_values = std::vector<std::vector<double>>(6)};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageResult const& stage = stages[k];
    table.names.push_back(stage.kind);
    double const row[] = {static_cast<double>(k + 1),
                          stage.packing_fraction,
                          stage.pressure.value_or(no_value),
                          stage.jamming_packing_fraction.value_or(no_value),
                          static_cast<double>(stage.pair_collisions),
                          static_cast<double>(stage.work)};
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
      {{.name = "backbone_disks", .documentation = "Disks that are no rattlers.", .is_count = true},
       count(&PressureLevel::backbone_disks)},
      {{"excess_contacts", "", "Contacts beyond those that a marginal packing has."}, &PressureLevel::excess_contacts},
      {{"bulk_modulus", "", "In ε/D²."}, &PressureLevel::bulk_modulus},
      {{"shear_modulus", "", "Mean over all directions, in ε/D²."}, &PressureLevel::shear_modulus},
      {{"simple_shear_modulus", "", "dσ/dγ of x ← x + γ y, in ε/D²."}, &PressureLevel::simple_shear_modulus},
      {{"pure_shear_modulus", "", "dσ/dγ of x ← x e^(γ/2), y ← y e^(−γ/2), in ε/D²."},
       &PressureLevel::pure_shear_modulus},
      {{"least_shear_modulus", "", "Of the softest direction, in ε/D²."}, &PressureLevel::least_shear_modulus},
      {{"residual", "", "Largest net force over the mean contact force."}, &PressureLevel::residual},
      {{.name = "iterations", .documentation = "Of the minimizer since the level before.", .is_count = true},
       count(&PressureLevel::iterations)},
      {{"jamming_packing_fraction", "", "Where the pressure vanishes, from the last two minima."},
       &PressureLevel::jamming_packing_fraction}};
}

Distribution levels_table(std::vector<StageResult> const& stages) {
  std::vector<LevelColumn> const columns = level_columns();
  Distribution table{
      .name = "levels",
      .columns = {{.name = "stage", .documentation = "The number of the stage, from 1.", .is_count = true}},
      .columns_of_values = {}};
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

/// Returns the table of contacts as `gridlock contacts` writes it; an analysis without contacts gives only columns.
Distribution contacts_curve(PackingAnalysis const& analysis) {
  static std::map<std::string, std::string, std::less<>> const documentation{
      {"i", "Id of a disk."},
      {"j", "Id of the disk that it touches; at a wall its own."},
      {"wall", "0 none, 1 left, 2 right, 3 bottom, 4 top."},
      {"distance", "r, between the centres, or to the wall."},
      {"normal_x", "Of the unit vector from i to j."},
      {"normal_y", "Of the unit vector from i to j."},
      {"overlap", "δ = 1 − r/σ."},
      {"force", "In ε per length."},
      {"image_x", "Sides of the box to the image of j that i touches."},
      {"image_y", "Sides of the box to the image of j that i touches."},
      {"backbone", "1 where both disks are of the backbone."}};
  Table const table = contacts_table(analysis);
  Distribution curve{.name = "contacts", .columns = {}, .columns_of_values = {}};
  for (std::string const& name : table.names()) {
    bool const is_count = std::holds_alternative<std::vector<std::uint64_t>>(table.column(name));
    curve.columns.push_back({.name = name, .documentation = documentation.at(name), .is_count = is_count});
    curve.columns_of_values.push_back(table.numbers(name));
  }
  return curve;
}

/// Returns a note on a stage; `number` counts stages from 0.
Event note_on(EventKind kind, StageResult const& stage, std::size_t number) {
  return {.kind = kind,
          .key = "protocol",
          .values = {{"stage", static_cast<std::uint64_t>(number + 1)},
                     {"name", stage.kind},
                     {"packing_fraction", stage.packing_fraction}}};
}

/// Returns whether disks exert pressure. Disks that the minimizer has moved apart may still overlap by rounding errors,
/// which do not count.
bool presses(StageResult const& stage) {
  PressureLevel const& level = stage.levels.back();
  bool const is_apart = level.backbone_disks == 0 && level.energy < min_energy_of_a_disk * stage.disks;
  return level.pressure > 0.0 && !is_apart;
}

/// Returns the note on a stage of swap Monte Carlo, a ramp or a quench that missed its goal.
std::optional<Event> note_on_end(StageResult const& stage, std::size_t number) {
  if (stage.swap && !stage.swap->is_equilibrated) {
    Event note = note_on(EventKind::stage_not_equilibrated, stage, number);
    std::optional<double> const times = stage.swap->relaxation_times;
    if (times && *times >= 10.0) {
      note.values.emplace_back("density_drift", stage.swap->density_drift.value_or(0.0));
    } else if (times && std::isfinite(*times)) {
      note.values.emplace_back("relaxation_times", *times);
    }
    return note;
  }
  if (stage.levels.empty()) return std::nullopt;
  if (stage.packing_fraction_without_minimum) {
    Event note = note_on(EventKind::stage_without_minimum, stage, number);
    note.values.back().second = *stage.packing_fraction_without_minimum;
    return note;
  }
  if (!presses(stage)) return note_on(EventKind::stage_without_pressure, stage, number);
  if (stage.is_converged.value_or(true)) return std::nullopt;
  Event note = note_on(EventKind::stage_fell_short, stage, number);
  note.values.emplace_back("pressure", stage.levels.back().pressure);
  return note;
}

/// Returns a note on hard disks whose pressure at the end of the protocol is so high that they hardly move.
std::optional<Event> note_on_growth(StageResult const& stage, std::size_t number) {
  constexpr double high_pressure = 1e3;
  if (!stage_record(stage.kind).ends_near_jamming) return std::nullopt;
  if (!(stage.pressure.value_or(0.0) >= high_pressure)) return std::nullopt;
  Event note = note_on(EventKind::jamming_not_known, stage, number);
  note.values.emplace_back("pressure", *stage.pressure);
  return note;
}

/// Returns a note on disks under pressure that are not jammed, so that their jamming packing fraction is not valid.
std::optional<Event> note_on_unjammed(StageResult const& stage, std::size_t number) {
  PressureLevel const& level = stage.levels.back();
  if (stage.is_jammed.value_or(true) || !presses(stage)) return std::nullopt;
  Event note = note_on(EventKind::packing_not_jammed, stage, number);
  if (level.backbone_disks == 0 || level.excess_contacts < 0.0) {
    note.values.emplace_back("backbone_disks", level.backbone_disks);
    note.values.emplace_back("missing_contacts", static_cast<std::uint64_t>(-std::min(level.excess_contacts, 0.0)));
  } else if (stage.softest_mode && *stage.softest_mode < min_eigenvalue_of_a_minimum(level.pressure)) {
    note.values.emplace_back("softest_mode", *stage.softest_mode);
  }
  note.values.emplace_back("residual", level.residual);
  if (stage.jamming_packing_fraction)
    note.values.emplace_back("jamming_packing_fraction", *stage.jamming_packing_fraction);
  return note;
}

/// Returns a note on soft disks with a packing fraction above 1, which hard disks cannot have.
std::optional<Event> note_on_density(StageResult const& stage, std::size_t number) {
  if (!(stage.packing_fraction > 1.0) || !stage.mean_overlap) return std::nullopt;
  Event note = note_on(EventKind::packing_too_dense, stage, number);
  note.values.emplace_back("mean_overlap", *stage.mean_overlap);
  return note;
}

/// Returns a note on a compression or shear that costs no energy. A periodic packing without excess contacts always has
/// such a shear, so it gets no note.
std::optional<Event> note_on_shear(StageResult const& stage, std::size_t number, bool is_periodic) {
  PressureLevel const& level = stage.levels.back();
  // The comparison is false without pressure, when the bulk modulus is NaN.
  if (gives_way(level)) {
    Event note = note_on(EventKind::packing_gives_way, stage, number);
    note.values.emplace_back("bulk_modulus", level.bulk_modulus);
    return note;
  }
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
    if (stage_record(stages[k].kind).may_end_without_pressure && k != last_soft) continue;
    if (auto note = note_on_end(stages[k], k)) notes.push_back(*std::move(note));
  }
  if (stages.empty()) return notes;
  if (auto note = note_on_growth(stages.back(), stages.size() - 1)) notes.push_back(*std::move(note));
  if (!last_soft) return notes;
  if (auto note = note_on_unjammed(stages[*last_soft], *last_soft)) notes.push_back(*std::move(note));
  if (auto note = note_on_density(stages[*last_soft], *last_soft)) notes.push_back(*std::move(note));
  if (auto note = note_on_shear(stages[*last_soft], *last_soft, is_periodic)) notes.push_back(*std::move(note));
  return notes;
}

}  // namespace

std::vector<ColumnInfo> protocol_results() {
  std::vector<ColumnInfo> results;
  for (ResultEntry const& entry : hard_entries()) results.push_back(entry.info);
  std::ranges::move(swap_entries(), std::back_inserter(results));
  for (ResultEntry const& entry : soft_entries()) results.push_back(entry.info);
  std::ranges::move(shear_entries(), std::back_inserter(results));
  return results;
}

std::vector<Distribution> protocol_tables() {
  std::vector<Distribution> tables{stages_table({}), levels_table({}), swap_table({}), density_table({}),
                                   contacts_curve({})};
  std::ranges::move(shear_tables({}), std::back_inserter(tables));
  return tables;
}

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
          .finished = protocol_.stage(),
          .state_hashes = protocol_.state_hashes()};
}

std::vector<Event> ProtocolSimulation::notes() const { return notes_on(protocol_.results(), state_.box.is_periodic()); }

/// Returns whether the last stage ends in a packing under pressure whose forces balance.
bool ProtocolSimulation::ends_at_minimum() const {
  if (!is_prepared_ || has_run() || protocol_.results().empty()) return false;
  StageResult const& last = protocol_.results().back();
  return is_soft(last) && presses(last) && (last.is_converged.value_or(false) || last.is_jammed.value_or(false));
}

/// Returns whether the run after the protocol has begun; before its first step it has no measurements.
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
  if (!has_run()) return results;
  for (NamedEstimate& of_run : simulation_->results()) {
    // The last packing has some of them too, such as the pressure.
    if (std::ranges::find(results, of_run.name, &NamedEstimate::name) != results.end()) of_run.name.insert(0, "mean_");
    results.push_back(std::move(of_run));
  }
  return results;
}

std::vector<Distribution> ProtocolSimulation::distributions() const {
  std::vector<Distribution> distributions;
  if (has_run()) distributions = simulation_->distributions();
  std::vector<StageResult> stages = protocol_.results();
  if (!stages.empty()) distributions.push_back(stages_table(stages));
  std::vector<Distribution> tables{levels_table(stages), swap_table(stages), density_table(stages)};
  stages.push_back({.shear = protocol_.shear_so_far()});
  std::ranges::move(shear_tables(stages), std::back_inserter(tables));
  for (Distribution& table : tables) {
    if (!table.columns_of_values.front().empty()) distributions.push_back(std::move(table));
  }
  if (ends_at_minimum())
    distributions.push_back(contacts_curve(find_contacts_of(state_, {.potential = soft_.potential})));
  return distributions;
}

void ProtocolSimulation::give_frame(UseFrame const& use) const {
  is_prepared_ ? simulation_->give_frame(use) : use(*frame_source_of(state_));
}

std::optional<FrameContacts> ProtocolSimulation::contacts() const {
  if (!is_prepared_ || has_run() || protocol_.results().empty() || protocol_.results().back().levels.empty()) {
    return std::nullopt;
  }
  ContactNetwork const network = find_contact_network(packing_of(state_), soft_.potential);
  if (!presses(protocol_.results().back())) return FrameContacts{.clock = start_clock_, .ids = {}, .forces = {}};
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
  // state_ is the state at the end of the protocol, from which the simulation begins.
  if (archive.is_restoring()) begin_simulation();
  serialize_inside(archive, "simulation", [&] { simulation_->serialize(archive); });
}

}  // namespace gridlock
