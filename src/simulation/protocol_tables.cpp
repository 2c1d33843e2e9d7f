#include "simulation/protocol_tables.hpp"

#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

namespace {

/// An entry of summary.json for a stage of Monte Carlo.
struct SwapEntry {
  ColumnInfo info;
  std::function<std::optional<Estimate>(SwapResult const&)> estimate_of;
  bool is_of_pressure = false;  ///< whether the entry is of the last stage at constant pressure
};

/// Returns the mean packing fraction at constant pressure.
std::optional<Estimate> density_at_pressure(SwapResult const& swap) {
  BlockAverage average;
  for (std::size_t k = swap.adjusting_stretches; k < swap.packing_fractions.size(); ++k)
    average.add(swap.packing_fractions[k]);
  return average.estimate();
}

std::vector<SwapEntry> entries_of_swap() {
  auto const number = [](std::optional<double> SwapResult::*member) {
    return [member](SwapResult const& swap) {
      return swap.*member ? std::optional(Estimate{.value = *(swap.*member), .error = {}}) : std::nullopt;
    };
  };
  return {
      {{"displacement_acceptance", "", "Share of the trial displacements that were accepted."},
       number(&SwapResult::displacement_acceptance)},
      {{"swap_acceptance", "", "Share of the trial swaps that were accepted."}, number(&SwapResult::swap_acceptance)},
      {{"area_acceptance", "", "Share of the trial changes of the area that were accepted."},
       number(&SwapResult::area_acceptance),
       true},
      {{"packing_fraction_at_pressure", "", "Mean φ at constant pressure, with the error of blocks."},
       density_at_pressure,
       true},
      {{"overlap_relaxation_time", "sweeps", "Where the share of disks in their old cages has fallen to 1/e."},
       number(&SwapResult::overlap_relaxation_time)},
      {{"bond_relaxation_time", "sweeps", "Where the correlation of the local hexatic order has fallen to 1/e."},
       number(&SwapResult::bond_relaxation_time)},
      {{"relaxation_times", "", "How many of the longer relaxation time the stage has lasted."},
       number(&SwapResult::relaxation_times)},
      {{"is_equilibrated", "", "1 where these are ten or more, and the density at a pressure does not drift; else 0."},
       [](SwapResult const& swap) {
         return std::optional(Estimate{.value = swap.is_equilibrated ? 1.0 : 0.0, .error = {}});
       }}};
}

ColumnInfo number_of_stage() {
  return {.name = "stage", .documentation = "The number of the stage, from 1.", .is_count = true};
}

ColumnInfo count(std::string_view name, std::string_view documentation) {
  return {.name = std::string(name), .documentation = std::string(documentation), .is_count = true};
}

Distribution table_with(std::string_view name, std::vector<ColumnInfo> columns) {
  Distribution table{.name = std::string(name), .columns = {number_of_stage()}, .columns_of_values = {}};
  for (ColumnInfo& column : columns) table.columns.push_back(std::move(column));
  table.columns_of_values.resize(table.columns.size());
  return table;
}

void add_row(Distribution& table, std::vector<double> const& row) {
  for (std::size_t c = 0; c < row.size(); ++c) table.columns_of_values[c].push_back(row[c]);
}

Distribution minima_table() {
  return table_with("shear", {{"strain", "", "γ of the minimum."},
                              {"shear_stress", "ε/D²", "σ = dE/dγ/A of the deformation."},
                              {"stress_xx", "ε/D²", "Of the stress tensor; below 0 under pressure."},
                              {"stress_yy", "ε/D²", "Of the stress tensor; below 0 under pressure."},
                              {"stress_xy", "ε/D²", "Of the stress tensor."},
                              {"pressure", "ε/D²", "Minus half of the trace of the stress tensor."},
                              {"energy", "ε", "Of all disks."},
                              count("contacts", "Pairs of disks that overlap.")});
}

Distribution events_table() {
  return table_with("shear_events",
                    {{"strain", "", "Last strain before the stress drops."},
                     {"width", "", "From there to the first strain after the drop."},
                     {"stress_drop", "ε/D²", "By which the shear stress falls."},
                     {"energy_drop", "ε", "By which the energy of all disks falls."},
                     count("moved_disks", "Disks that move by more than 0.01 D against the affine motion."),
                     {"participation", "disks", "(Σ u²)²/Σ u⁴ of the motions u of all disks."},
                     {"largest_motion", "D", "Of a disk."},
                     {"softest_mode", "ε/D²", "Smallest eigenvalue of the Hessian before the drop."},
                     {"mode_overlap", "", "Share of the motion along this mode, |u·e|/|u|."}});
}

Distribution motions_table() {
  return table_with("shear_motions", {count("event", "The number of the event of this stage, from 1."),
                                      count("disk", "The number of the disk in the order of the Ids, from 0."),
                                      {"x", "length", "Place before the event."},
                                      {"y", "length", "Place before the event."},
                                      {"motion_x", "length", "Motion in the event, against the affine one."},
                                      {"motion_y", "length", "Motion in the event, against the affine one."}});
}

Distribution cycles_table() {
  return table_with("shear_cycles",
                    {count("cycle", "The number of the cycle, from 1."),
                     {"largest_motion", "D", "Of a disk from the end of the cycle before to this one."},
                     count("is_reversible", "1 where no disk has moved by more than 0.001 D, else 0.")});
}

void add_stage(double stage, ShearResult const& shear, std::vector<Distribution>& tables) {
  for (ShearedMinimum const& minimum : shear.minima) {
    StressTensor const& stress = minimum.stress;
    add_row(tables[0], {stage, minimum.strain, minimum.shear_stress, stress.xx, stress.yy, stress.xy,
                        0.5 * (0.0 - stress.xx - stress.yy), minimum.energy, static_cast<double>(minimum.contacts)});
  }
  for (ShearEvent const& event : shear.events) {
    add_row(tables[1], {stage, event.strain, event.width, event.stress_drop, event.energy_drop, event.moved_disks,
                        event.participation, event.largest_motion, event.softest_mode, event.mode_overlap});
  }
  for (EventMotion const& motion : shear.motions) {
    add_row(tables[2], {stage, static_cast<double>(motion.event + 1), static_cast<double>(motion.disk), motion.place.x,
                        motion.place.y, motion.motion.x, motion.motion.y});
  }
  for (std::size_t k = 0; k < shear.cycles.size(); ++k) {
    add_row(tables[3], {stage, static_cast<double>(k + 1), shear.cycles[k].largest_motion,
                        shear.cycles[k].is_reversible ? 1.0 : 0.0});
  }
}

}  // namespace

Distribution swap_table(std::vector<StageResult> const& stages) {
  Distribution table{
      .name = "swap_correlations",
      .columns = {{.name = "stage", .documentation = "The number of the stage, from 1.", .is_count = true},
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

Distribution density_table(std::vector<StageResult> const& stages) {
  Distribution table =
      table_with("swap_density", {count("sweeps_done", "Sweeps of the stage at the end of a stretch of sweeps."),
                                  {"packing_fraction", "", "Mean of φ in the stretch."}});
  for (std::size_t k = 0; k < stages.size(); ++k) {
    if (!stages[k].swap) continue;
    SwapResult const& swap = *stages[k].swap;
    for (std::size_t i = 0; i < swap.density_sweeps.size(); ++i)
      add_row(table, {static_cast<double>(k + 1), swap.density_sweeps[i], swap.packing_fractions[i]});
  }
  return table;
}

std::vector<Distribution> shear_tables(std::vector<StageResult> const& stages) {
  std::vector<Distribution> tables{minima_table(), events_table(), motions_table(), cycles_table()};
  for (std::size_t k = 0; k < stages.size(); ++k) {
    if (stages[k].shear) add_stage(static_cast<double>(k + 1), *stages[k].shear, tables);
  }
  return tables;
}

std::vector<ColumnInfo> swap_entries() {
  std::vector<ColumnInfo> infos;
  for (SwapEntry const& entry : entries_of_swap()) infos.push_back(entry.info);
  return infos;
}

std::vector<NamedEstimate> swap_results(std::vector<StageResult> const& stages) {
  SwapResult const* last = nullptr;
  SwapResult const* at_pressure = nullptr;
  for (StageResult const& stage : stages) {
    if (!stage.swap) continue;
    last = &*stage.swap;
    if (!last->packing_fractions.empty()) at_pressure = last;
  }
  std::vector<NamedEstimate> results;
  for (SwapEntry const& entry : entries_of_swap()) {
    SwapResult const* const swap = entry.is_of_pressure ? at_pressure : last;
    if (swap == nullptr) continue;
    std::optional<Estimate> const estimate = entry.estimate_of(*swap);
    if (estimate && std::isfinite(estimate->value)) results.push_back({entry.info.name, *estimate, ""});
  }
  return results;
}

std::vector<ColumnInfo> shear_entries() {
  return {{"shear_strain", "", "γ at the end of the last stage shear."},
          {"shear_stress", "ε/D²", "σ = dE/dγ/A at its end."},
          {"flow_stress", "ε/D²", "Mean of σ over the second half of its minima, with the error of blocks."},
          {"first_shear_modulus", "ε/D²", "Slope of σ over γ between its first two minima."},
          {"shear_events", "", "Drops of the stress: rearrangements."},
          {"first_event_strain", "", "γ of the first of them."},
          {"mean_stress_drop", "ε/D²", "Mean of the drops."},
          {"reversible_cycles", "", "Cycles after which each disk is where it was before."},
          {"irreversible_cycles", "", "All other cycles."}};
}

std::vector<NamedEstimate> shear_results(ShearResult const& shear) {
  std::vector<NamedEstimate> results;
  auto const add = [&](std::string_view name, Estimate estimate) {
    if (std::isfinite(estimate.value)) results.push_back({std::string(name), estimate, ""});
  };
  if (shear.minima.empty()) return results;
  add("shear_strain", {.value = shear.minima.back().strain, .error = {}});
  add("shear_stress", {.value = shear.minima.back().shear_stress, .error = {}});
  BlockAverage flow;
  for (std::size_t k = shear.minima.size() / 2; k < shear.minima.size(); ++k) flow.add(shear.minima[k].shear_stress);
  if (shear.cycles.empty()) add("flow_stress", flow.estimate().value_or(Estimate{.value = no_value, .error = {}}));
  if (shear.minima.size() > 1) {
    double const strain = shear.minima[1].strain - shear.minima[0].strain;
    add("first_shear_modulus",
        {.value = (shear.minima[1].shear_stress - shear.minima[0].shear_stress) / strain, .error = {}});
  }
  add("shear_events", {.value = static_cast<double>(shear.events.size()), .error = {}});
  if (!shear.events.empty()) {
    add("first_event_strain", {.value = shear.events.front().strain, .error = {}});
    double sum = 0.0;
    for (ShearEvent const& event : shear.events) sum += event.stress_drop;
    add("mean_stress_drop", {.value = sum / static_cast<double>(shear.events.size()), .error = {}});
  }
  if (shear.cycles.empty()) return results;
  double reversible = 0.0;
  for (ShearCycle const& cycle : shear.cycles) reversible += cycle.is_reversible ? 1.0 : 0.0;
  add("reversible_cycles", {.value = reversible, .error = {}});
  add("irreversible_cycles", {.value = static_cast<double>(shear.cycles.size()) - reversible, .error = {}});
  return results;
}

}  // namespace gridlock
