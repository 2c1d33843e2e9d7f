#include "study/turn_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "observe/mean_over_runs.hpp"
#include "study/figures.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

double TurnOrderComparison::error() const { return std::hypot(by_id.error.value_or(0.0), by_tile.error.value_or(0.0)); }

bool TurnOrderComparison::is_known() const { return seeds > 1 && error() > 0.0; }

double TurnOrderComparison::deviation() const { return (by_tile.value - by_id.value) / error(); }

bool TurnOrderComparison::differs() const { return is_known() && std::abs(deviation()) > three_sigma(2 * (seeds - 1)); }

double TurnOrderComparison::deviation_pairwise() const {
  double const one = difference.error.value_or(0.0);
  return one > 0.0 ? difference.value / one : 0.0;
}

bool TurnOrderComparison::differs_pairwise() const {
  return is_known() && std::abs(deviation_pairwise()) > three_sigma(seeds - 1);
}

double TurnOrderComparison::resolution() const {
  return three_sigma(seeds - 1) * difference.error.value_or(0.0) / std::abs(by_id.value);
}

Estimate TurnOrderComparison::relative_difference() const {
  return {.value = difference.value / by_id.value, .error = difference.error.value_or(0.0) / std::abs(by_id.value)};
}

double TurnOrderComparison::distance_from_reference() const { return by_id.value / reference.value - 1.0; }

namespace {

// The engines that differ in the order of the turns alone, and the one without turns.
constexpr char const* stepped = "stepped";
constexpr char const* tiled = "tiled";
constexpr char const* exact = "exact";

/// The same runs in both orders of turns, and without turns.
struct Orders {
  ReplicaSet by_id;
  ReplicaSet by_tile;
  ReplicaSet reference;
};

Orders orders_at(PaperExtent const& extent, StartKind start, Edge edge, double density, double time_step) {
  auto const replica_set = [&](char const* kind, double step) -> ReplicaSet {
    return sampled_evenly({.engine = {kind, kind},
                           .start = start,
                           .edge = edge,
                           .packing_fraction = density,
                           .time_step = step,
                           .seeds = extent.order_seeds},
                          extent.order_diameters, 256);
  };
  return {replica_set(stepped, time_step), replica_set(tiled, time_step), replica_set(exact, usual_time_step)};
}

std::vector<Orders> orders_of(PaperExtent const& extent) {
  std::vector<Orders> orders;
  auto const add = [&](StartKind start, Edge edge, std::vector<double> const& densities) {
    for (double const density : densities) {
      for (double const step : extent.order_time_steps) orders.push_back(orders_at(extent, start, edge, density, step));
    }
  };
  add(StartKind::square, Edge::wall, extent.order_square_densities);
  add(StartKind::triangular, Edge::wall, extent.order_triangular_densities);
  add(StartKind::square, Edge::periodic, extent.order_periodic_densities);
  return orders;
}

using Comparison = TurnOrderComparison;
using Row = TurnOrderRow;

template <class Value>
Comparison compare(ReplicaResult const& by_id, ReplicaResult const& by_tile, ReplicaResult const& reference,
                   Value value) {
  std::vector<double> const here = by_id.of_each_seed(value);
  std::vector<double> const there = by_tile.of_each_seed(value);
  std::vector<double> differences;
  for (std::size_t k = 0; k < here.size(); ++k) differences.push_back(there[k] - here[k]);
  return {.by_id = mean_over_runs(here),
          .by_tile = mean_over_runs(there),
          .reference = mean_over_runs(reference.of_each_seed(value)),
          .difference = mean_over_runs(differences),
          .seeds = here.size()};
}

/// What does not change with time but for chance, each over the last half of the runs.
struct Quantity {
  char const* name;
  char const* column;
  std::vector<double> StudyOutcome::*values;
  bool is_of_walls;
};
constexpr std::array quantities{
    Quantity{"pressure on the walls", "wall_pressure", &StudyOutcome::wall_pressures, true},
    Quantity{"compressibility factor", "compressibility_factor", &StudyOutcome::compressibility_factors, false},
    Quantity{"collisions per disk and time", "collision_rate", &StudyOutcome::collision_rates, false}};
constexpr double share_that_counts = 0.5;

/// The samples of a curve that are compared: the end, a quarter of the run, a sixteenth …
std::vector<std::size_t> compared_samples_of(std::size_t samples) {
  std::vector<std::size_t> samples_compared;
  for (std::size_t sample = samples - 1; sample >= 1; sample /= 4) samples_compared.push_back(sample);
  std::ranges::reverse(samples_compared);
  return samples_compared;
}

std::vector<PageCell> names_of(Row const& row) {
  return {name_of(row.start), name_of(row.edge), fmt::format("{}", row.packing_fraction),
          fmt::format("{}", row.time_step)};
}

std::string place_of(Row const& row) {
  return fmt::format("φ = {} {}{}", row.packing_fraction, name_of(row.start),
                     row.edge == Edge::periodic ? " periodic" : "");
}

std::vector<Row> rows_of(Study const& study) {
  std::vector<Row> rows;
  for (Orders const& orders : orders_of(study.extent())) {
    ReplicaResult const by_id(study, orders.by_id);
    ReplicaResult const by_tile(study, orders.by_tile);
    ReplicaResult const reference(study, orders.reference);
    // A run without its partner would be compared with another start's.
    bool const is_complete = by_id.seeds() == orders.by_id.seeds && by_tile.seeds() == orders.by_id.seeds;
    if (!is_complete || reference.seeds() == 0) continue;
    Edge const edge = orders.by_id.edge;
    Row row{.start = orders.by_id.start,
            .edge = edge,
            .packing_fraction = orders.by_id.packing_fraction,
            .time_step = orders.by_id.time_step};
    auto const compare_at = [&](std::size_t sample, std::vector<double> StudyOutcome::*values) {
      return compare(by_id, by_tile, reference, [=](StudyOutcome const& outcome) { return (outcome.*values)[sample]; });
    };
    for (std::size_t const sample : compared_samples_of(by_id.samples())) {
      row.times.push_back(by_id.step(sample) * row.time_step);
      row.displacements.push_back(compare_at(
          sample, edge == Edge::wall ? &StudyOutcome::displacements : &StudyOutcome::displacements_about_centre));
      row.centres.push_back(compare_at(sample, &StudyOutcome::centre_displacements));
    }
    row.whole = compare_at(by_id.samples() - 1, &StudyOutcome::displacements);
    for (Quantity const& quantity : quantities) {
      if (!quantity.is_of_walls || edge == Edge::wall) {
        row.rates.push_back(compare(by_id, by_tile, reference, [&](StudyOutcome const& outcome) {
          return tail_mean(outcome.*quantity.values, share_that_counts);
        }));
      } else {
        row.rates.emplace_back();
      }
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Table curves_of(Study const& study) {
  Table table;
  for (char const* name : {"engine", "start", "edge"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "time_step", "diameters", "mean_displacement", "mean_displacement_error",
                           "centre_displacement", "centre_displacement_error", "displacement_about_centre",
                           "displacement_about_centre_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (Orders const& orders : orders_of(study.extent())) {
    for (ReplicaSet const& replica_set : {orders.by_id, orders.by_tile}) {
      ReplicaResult const result(study, replica_set);
      for (std::size_t const sample : result.samples_spread_out(4)) {
        std::vector<Cell> cells{replica_set.engine.kind,   name_of(replica_set.start),
                                name_of(replica_set.edge), replica_set.packing_fraction,
                                replica_set.time_step,     result.step(sample) * replica_set.time_step};
        for (auto const values : {&StudyOutcome::displacements, &StudyOutcome::centre_displacements,
                                  &StudyOutcome::displacements_about_centre}) {
          Estimate const estimate = mean_over_runs(
              result.of_each_seed([&](StudyOutcome const& outcome) { return (outcome.*values)[sample]; }));
          cells.emplace_back(estimate.value);
          cells.emplace_back(estimate.error.value_or(std::nan("")));
        }
        table.add_row(cells);
      }
    }
  }
  return table;
}

Table comparisons_of(std::vector<Row> const& rows) {
  Table table;
  for (char const* name : {"quantity", "start", "edge"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "time_step", "diameters", "stepped", "stepped_error", "tiled",
                           "tiled_error", "deviation", "difference", "difference_error", "exact", "exact_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  table.add_column("seeds", std::vector<std::uint64_t>{});
  double const nothing = std::nan("");
  for (Row const& row : rows) {
    auto const add = [&](char const* quantity, double diameters, Comparison const& one) {
      table.add_row(std::vector<Cell>{
          quantity, name_of(row.start), name_of(row.edge), row.packing_fraction, row.time_step, diameters,
          one.by_id.value, one.by_id.error.value_or(nothing), one.by_tile.value, one.by_tile.error.value_or(nothing),
          one.is_known() ? one.deviation() : nothing, one.difference.value, one.difference.error.value_or(nothing),
          one.reference.value, one.reference.error.value_or(nothing), static_cast<std::uint64_t>(one.seeds)});
    };
    bool const is_periodic = row.edge == Edge::periodic;
    for (std::size_t k = 0; k < row.times.size(); ++k) {
      add(is_periodic ? "displacement_about_centre" : "mean_displacement", row.times[k], row.displacements[k]);
      if (is_periodic) add("centre_displacement", row.times[k], row.centres[k]);
    }
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      if (row.rates[k].seeds > 0) add(quantities[k].column, nothing, row.rates[k]);
    }
  }
  return table;
}

void draw_curves(Study& study, std::vector<Row> const& rows) {
  Plot plot{.name = "turn_order",
            .title = "The order of the turns",
            .x = {.label = "time / (diameters per v_max)", .is_logarithmic = true},
            .y = {.label = "mean displacement / side of the box", .is_logarithmic = true},
            .key = PlotKey::outside,
            .key_title = "lines: stepped\npoints: tiled"};
  std::size_t colour = 0;
  for (Row const& row : rows) {
    if (row.edge != Edge::wall || row.time_step != study.extent().order_time_steps.front()) continue;
    for (char const* kind : {stepped, tiled}) {
      plot.curves.push_back(
          {.label = kind == tiled ? "" : fmt::format("{} {}", name_of(row.start), row.packing_fraction),
           .file = "turn_order.csv",
           .x = "diameters",
           .y = "mean_displacement",
           .error = "mean_displacement_error",
           .where = {{.column = "engine", .equals = kind},
                     {.column = "start", .equals = name_of(row.start)},
                     {.column = "edge", .equals = name_of(row.edge)},
                     {.column = "packing_fraction", .equals = fmt::format("{}", row.packing_fraction)},
                     {.column = "time_step", .equals = fmt::format("{}", row.time_step)}},
           .style = kind == tiled ? PlotStyle::points : PlotStyle::line,
           .colour = colour});
    }
    ++colour;
  }
  if (!plot.curves.empty()) study.draw(plot);
}

std::string deviation_text(Comparison const& one) {
  return one.is_known() ? fmt::format("{:+.1f}{}", one.deviation(), one.differs() ? " *" : "") : "–";
}

PageTable displacement_table(std::vector<Row> const& rows) {
  PageTable table{.header = {"start", "edges", "φ", "time step", "stepped", "tiled", "exact"},
                  .caption =
                      "Mean displacement over the side at the end of the runs (in a periodic box the root mean square "
                      "about the centre), and (tiled − stepped) / standard error after some times, in diameters per "
                      "v_max. A star: chance explains it in less than 0.3 % of all cases."};
  for (double const time : rows.front().times) table.header.push_back(fmt::format("after {:.3g}", time));
  for (Row const& row : rows) {
    std::vector<PageCell> cells = names_of(row);
    Comparison const& last = row.displacements.back();
    for (Estimate const& estimate : {last.by_id, last.by_tile, last.reference}) cells.emplace_back(to_text(estimate));
    for (Comparison const& one : row.displacements) cells.emplace_back(deviation_text(one));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

PageTable rate_table(std::vector<Row> const& rows) {
  PageTable table{.header = {"quantity", "start", "edges", "φ", "time step", "stepped", "tiled",
                             "difference / standard error", "difference start by start, %", "exact"},
                  .caption =
                      "Over the last half of the runs. A star: chance explains it in less than 0.3 % of all cases. "
                      "The difference start by start is the sharper test, and the one that counts below."};
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    for (Row const& row : rows) {
      Comparison const& one = row.rates[k];
      if (one.seeds == 0) continue;
      Estimate percent = one.relative_difference();
      percent = {.value = 100.0 * percent.value, .error = 100.0 * percent.error.value_or(0.0)};
      std::vector<PageCell> cells{quantities[k].name};
      std::ranges::copy(names_of(row), std::back_inserter(cells));
      for (std::string const& text :
           {to_text(one.by_id), to_text(one.by_tile), deviation_text(one),
            to_text(percent) + (one.differs_pairwise() ? " *" : ""), to_text(one.reference)}) {
        cells.emplace_back(text);
      }
      table.rows.push_back(std::move(cells));
    }
  }
  return table;
}

/// The centre of the disks in a periodic box, which nothing holds.
PageTable centre_table(std::vector<Row> const& rows) {
  PageTable table{.header = {"start", "φ", "time step", "centre: stepped", "tiled", "exact",
                             "mean displacement: stepped", "tiled", "exact"},
                  .caption =
                      "Periodic boxes: how far the centre of the disks has come at the end of the runs, and the mean "
                      "displacement that has it in it, over the side."};
  for (Row const& row : rows) {
    if (row.edge != Edge::periodic) continue;
    std::vector<PageCell> cells{name_of(row.start), fmt::format("{}", row.packing_fraction),
                                fmt::format("{}", row.time_step)};
    for (Comparison const& one : {row.centres.back(), row.whole}) {
      for (Estimate const& estimate : {one.by_id, one.by_tile, one.reference}) {
        // What is left of an exact centre is rounding.
        cells.emplace_back(std::abs(estimate.value) < 1e-9 ? "0" : to_text(estimate));
      }
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// What the comparisons of one time step show.
struct Findings {
  std::size_t count = 0;
  double squares = 0.0;  ///< of the deviations, in standard errors
  std::vector<std::string> differing;
  std::vector<double> resolutions;  ///< the smallest differences of pressures and collision rates that would count
};

Findings findings_at(std::vector<Row> const& rows, double step) {
  Findings findings;
  auto const look = [&](std::string const& what, Row const& row, Comparison const& one, double deviation,
                        bool differs) {
    if (!one.is_known()) return;
    ++findings.count;
    findings.squares += deviation * deviation;
    if (!differs) return;
    findings.differing.push_back(fmt::format("{} at {} ({:+.2g} %, {:+.1f} standard errors)", what, place_of(row),
                                             100.0 * (one.by_tile.value / one.by_id.value - 1.0), deviation));
  };
  for (Row const& row : rows) {
    if (row.time_step != step) continue;
    for (std::size_t k = 0; k < row.times.size(); ++k) {
      Comparison const& one = row.displacements[k];
      look(fmt::format("displacement after {:.3g}", row.times[k]), row, one, one.deviation(), one.differs());
    }
    for (std::size_t k = 0; k < quantities.size(); ++k) {
      Comparison const& one = row.rates[k];
      look(quantities[k].name, row, one, one.deviation_pairwise(), one.differs_pairwise());
      if (one.is_known()) findings.resolutions.push_back(one.resolution());
    }
  }
  std::ranges::sort(findings.resolutions);
  return findings;
}

std::string agreement_text(Findings const& findings, double step) {
  if (findings.count == 0) return fmt::format("Steps of {}: too few runs to tell.", step);
  std::string text = fmt::format(
      "With steps of {}, {} of {} comparisons of displacements, pressures and collision rates show no difference "
      "(root mean square of the deviations: {:.2f} standard errors){}{}.",
      step, findings.count - findings.differing.size(), findings.count,
      std::sqrt(findings.squares / static_cast<double>(findings.count)),
      findings.differing.empty() ? "" : "; by more than chance explains in 0.3 % of all cases differ: ",
      fmt::join(findings.differing, ", "));
  if (!findings.resolutions.empty()) {
    text += fmt::format(
        " So many starts show a difference of pressures and collision rates from {:.2g} % on (the median; {:.2g} % in "
        "the worst case); a smaller one would go unseen.",
        100.0 * findings.resolutions[findings.resolutions.size() / 2], 100.0 * findings.resolutions.back());
  }
  return text;
}

/// Whether what differs goes away with the time step.
std::string verdict_text(std::vector<Row> const& rows, std::vector<double> const& steps) {
  double const longest = std::ranges::max(steps);
  double const shortest = std::ranges::min(steps);
  Findings const coarse = findings_at(rows, longest);
  Findings const fine = findings_at(rows, shortest);
  if (coarse.count == 0 || fine.count == 0) return "Too few runs to say what the order of the turns changes.";
  if (coarse.differing.empty() && fine.differing.empty()) {
    return fmt::format("**In short:** no difference shows with steps of {}, to the accuracy of these runs.",
                       longest == shortest ? fmt::format("{}", longest) : fmt::format("{} or {}", longest, shortest));
  }
  if (longest == shortest) {
    return fmt::format("**In short:** with steps of {} the order of the turns changes what is measured.", longest);
  }
  if (fine.differing.empty()) {
    return fmt::format(
        "**In short:** with steps of {} the order of the turns changes what is measured; with steps of {} no "
        "difference "
        "shows to the accuracy of these runs. So it is an effect of the finite time step, as far as they can tell.",
        longest, shortest);
  }
  return fmt::format("**In short:** {} of {} comparisons differ with steps of {}, and {} of {} with steps of {}: {}.",
                     coarse.differing.size(), coarse.count, longest, fine.differing.size(), fine.count, shortest,
                     fine.differing.size() < coarse.differing.size()
                         ? "fewer, but the shorter step does not take all of it away"
                         : "the shorter step does not take it away");
}

/// How much the order matters beside the step itself: the largest differences over all densities for each time step.
std::string order_and_step_text(std::vector<Row> const& rows, std::vector<double> const& steps) {
  std::vector<std::string> parts;
  for (double const step : steps) {
    double of_order = 0.0;
    double of_step = 0.0;
    for (Row const& row : rows) {
      if (row.time_step != step) continue;
      for (Comparison const& one : row.rates) {
        if (!one.is_known()) continue;
        of_order = std::max(of_order, std::abs(one.relative_difference().value));
        of_step = std::max(of_step, std::abs(one.distance_from_reference()));
      }
    }
    parts.push_back(
        fmt::format("{:.1f} % with steps of {}, which themselves shift them by up to {:.0f} % from those of "
                    "exact disks",
                    100.0 * of_order, step, 100.0 * of_step));
  }
  return fmt::format(
      "Start by start, which is sharper than the errors of the means, pressures and collision rates of the two orders "
      "differ by at most {}.",
      fmt::join(parts, ", and "));
}

/// How far the centre of the disks travels in a periodic box, and whether it matters beside the disks' own
/// displacements.
std::string centre_text(std::vector<Row> const& rows) {
  constexpr double share_that_matters = 0.05;
  std::vector<std::string> parts;
  double largest_share = 0.0;
  double most_of_exact = 0.0;
  for (Row const& row : rows) {
    if (row.edge != Edge::periodic) continue;
    Comparison const& centre = row.centres.back();
    Comparison const& about = row.displacements.back();
    parts.push_back(fmt::format("{:.2g} of the side in stepped and {:.2g} in tiled at φ = {} with steps of {}",
                                centre.by_id.value, centre.by_tile.value, row.packing_fraction, row.time_step));
    most_of_exact = std::max(most_of_exact, centre.reference.value);
    largest_share =
        std::max({largest_share, centre.by_id.value / about.by_id.value, centre.by_tile.value / about.by_tile.value});
  }
  if (parts.empty()) return "";
  return fmt::format(
      "**In a periodic box** the total momentum is zero. The centre of the disks has come as far as {} at the end; "
      "that "
      "of exact disks {:.1g} at most. {}",
      fmt::join(parts, ", "), most_of_exact,
      largest_share > share_that_matters
          ? fmt::format("That is up to {:.2g} times the root mean square displacement about the centre: halting keeps "
                        "the momentum, but a halted disk does not move, and which disks halt depends on the "
                        "order. It is in the mean displacements of the last table, and is taken out above.",
                        largest_share)
          : fmt::format("It does not matter beside the displacements about the centre: at most {:.1g} times as much.",
                        largest_share));
}

}  // namespace

std::vector<std::string> conclusions_from(std::vector<TurnOrderRow> const& rows,
                                          std::vector<double> const& time_steps) {
  std::vector<std::string> conclusions;
  for (double const step : time_steps) conclusions.push_back(agreement_text(findings_at(rows, step), step));
  conclusions.push_back(order_and_step_text(rows, time_steps));
  conclusions.push_back(verdict_text(rows, time_steps));
  if (std::string const text = centre_text(rows); !text.empty()) conclusions.push_back(text);
  return conclusions;
}

void plan_turn_order(Study& study) {
  for (Orders const& orders : orders_of(study.extent())) {
    for (ReplicaSet const& replica_set : {orders.by_id, orders.by_tile, orders.reference}) plan(study, replica_set);
  }
}

Chapter turn_order(Study& study) {
  Chapter chapter{.title = "The order of the turns: stepped and tiled"};
  std::vector<Row> const rows = rows_of(study);
  if (rows.empty()) return chapter;
  study.write(curves_of(study), "turn_order.csv");
  study.write(comparisons_of(rows), "turn_order_comparisons.csv");
  draw_curves(study, rows);
  chapter.introduction.push_back(fmt::format(
      "The paper's disks take their turns one after the other; in which order, it does not say. The engine stepped "
      "goes "
      "by the names of the disks, the engine tiled tile by tile through the box, so that many cores can share the "
      "work. "
      "Single trajectories part after a few collisions. Both orders are the same rule; what is measured of them may "
      "differ "
      "as far as the step is finite. Both, and the exact dynamics, from the same {} starts at each density, for {} "
      "diameters per v_max.",
      study.extent().order_seeds, study.extent().order_diameters));
  chapter.drawings.push_back({{"turn_order.svg"}, "Lines: stepped. Points: tiled."});
  chapter.tables.push_back(displacement_table(rows));
  chapter.tables.push_back(rate_table(rows));
  bool const has_periodic = std::ranges::any_of(rows, [](Row const& row) { return row.edge == Edge::periodic; });
  if (has_periodic) chapter.tables.push_back(centre_table(rows));
  chapter.conclusions = conclusions_from(rows, study.extent().order_time_steps);
  return chapter;
}

}  // namespace gridlock
