#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "study/figures.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

// The engines that differ in the order of the turns alone, and the one without turns.
constexpr char const* stepped = "stepped";
constexpr char const* tiled = "tiled";
constexpr char const* exact = "exact";

/// The same runs in both orders of turns, and without turns.
struct Orders {
  Ensemble by_id;
  Ensemble by_tile;
  Ensemble reference;
};

constexpr double usual_time_step = 0.1;

Orders orders_at(PaperExtent const& extent, StartKind start, double density, double time_step) {
  auto const ensemble = [&](char const* kind, double step) -> Ensemble {
    return sampled_evenly({.engine = {kind, kind},
                           .start = start,
                           .packing_fraction = density,
                           .time_step = step,
                           .seeds = extent.order_seeds},
                          extent.order_diameters, 256);
  };
  return {ensemble(stepped, time_step), ensemble(tiled, time_step), ensemble(exact, usual_time_step)};
}

std::vector<Orders> orders_of(PaperExtent const& extent) {
  std::vector<Orders> orders;
  auto const add = [&](StartKind start, double density) {
    for (double const step : extent.order_time_steps) orders.push_back(orders_at(extent, start, density, step));
  };
  for (double const density : extent.order_square_densities) add(StartKind::square, density);
  for (double const density : extent.order_triangular_densities) add(StartKind::triangular, density);
  return orders;
}

/// One quantity measured in both orders from the same starts, and without a time step.
struct Comparison {
  Estimate by_id;
  Estimate by_tile;
  Estimate reference;
  Estimate difference;  ///< tiled minus stepped, mean and error over the pairs of runs from one start
  std::size_t seeds = 0;

  [[nodiscard]] double error() const { return std::hypot(by_id.error.value_or(0.0), by_tile.error.value_or(0.0)); }
  [[nodiscard]] bool is_known() const { return seeds > 1 && error() > 0.0; }
  /// In standard errors of two independent means.
  [[nodiscard]] double deviation() const { return (by_tile.value - by_id.value) / error(); }
  /// Whether chance explains it in less than 0.3 % of all cases.
  [[nodiscard]] bool differs() const { return is_known() && std::abs(deviation()) > three_sigma(2 * (seeds - 1)); }
  /// The same from start to start, which is sharper: what the two orders share of a start's own pressure drops out.
  [[nodiscard]] bool differs_pairwise() const {
    return is_known() && std::abs(difference.value) > three_sigma(seeds - 1) * difference.error.value_or(0.0);
  }
  /// Of the value of `stepped`.
  [[nodiscard]] Estimate relative_difference() const {
    return {.value = difference.value / by_id.value, .error = difference.error.value_or(0.0) / std::abs(by_id.value)};
  }
  [[nodiscard]] double distance_from_reference() const { return by_id.value / reference.value - 1.0; }
};

template <class Value>
Comparison compare(EnsembleResult const& by_id, EnsembleResult const& by_tile, EnsembleResult const& reference,
                   Value value) {
  std::vector<double> const here = by_id.of_each_seed(value);
  std::vector<double> const there = by_tile.of_each_seed(value);
  std::vector<double> differences;
  for (std::size_t k = 0; k < here.size(); ++k) differences.push_back(there[k] - here[k]);
  return {.by_id = mean_over_seeds(here),
          .by_tile = mean_over_seeds(there),
          .reference = mean_over_seeds(reference.of_each_seed(value)),
          .difference = mean_over_seeds(differences),
          .seeds = here.size()};
}

/// What does not change with time but for chance, each over the last half of the runs.
struct Quantity {
  char const* name;
  char const* column;
  std::vector<double> StudyOutcome::*values;
};
constexpr std::array quantities{
    Quantity{"pressure on the walls", "wall_pressure", &StudyOutcome::wall_pressures},
    Quantity{"compressibility factor", "compressibility_factor", &StudyOutcome::compressibility_factors},
    Quantity{"collisions per disk and time", "collision_rate", &StudyOutcome::collision_rates}};
constexpr double share_that_counts = 0.5;

/// The moments of a curve that are compared: the end, a quarter of the run, a sixteenth …
std::vector<std::size_t> moments_of(std::size_t samples) {
  std::vector<std::size_t> moments;
  for (std::size_t sample = samples - 1; sample >= 1; sample /= 4) moments.push_back(sample);
  std::ranges::reverse(moments);
  return moments;
}

/// All that is compared for one start, density and time step.
struct Row {
  StartKind start = StartKind::square;
  double packing_fraction = 0.0;
  double time_step = 0.0;
  std::vector<double> moments;            ///< in diameters per v_max
  std::vector<Comparison> displacements;  ///< at the moments
  std::vector<Comparison> rates;          ///< in the order of `quantities`

  [[nodiscard]] std::vector<PageCell> names() const {
    return {name_of(start), fmt::format("{}", packing_fraction), fmt::format("{}", time_step)};
  }
};

std::vector<Row> rows_of(Study const& study) {
  std::vector<Row> rows;
  for (Orders const& orders : orders_of(study.extent())) {
    EnsembleResult const by_id(study, orders.by_id);
    EnsembleResult const by_tile(study, orders.by_tile);
    EnsembleResult const reference(study, orders.reference);
    // A run without its partner would be compared with another start's.
    bool const is_complete = by_id.seeds() == orders.by_id.seeds && by_tile.seeds() == orders.by_id.seeds;
    if (!is_complete || reference.seeds() == 0) continue;
    Row row{.start = orders.by_id.start,
            .packing_fraction = orders.by_id.packing_fraction,
            .time_step = orders.by_id.time_step};
    for (std::size_t const sample : moments_of(by_id.samples())) {
      row.moments.push_back(by_id.step(sample) * row.time_step);
      row.displacements.push_back(compare(by_id, by_tile, reference,
                                          [=](StudyOutcome const& outcome) { return outcome.displacements[sample]; }));
    }
    for (Quantity const& quantity : quantities) {
      row.rates.push_back(compare(by_id, by_tile, reference, [&](StudyOutcome const& outcome) {
        return tail_mean(outcome.*quantity.values, share_that_counts);
      }));
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Table curves_of(Study const& study) {
  Table table;
  for (char const* name : {"engine", "start"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name :
       {"packing_fraction", "time_step", "diameters", "mean_displacement", "mean_displacement_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (Orders const& orders : orders_of(study.extent())) {
    for (Ensemble const& ensemble : {orders.by_id, orders.by_tile}) {
      EnsembleResult const result(study, ensemble);
      for (std::size_t const sample : result.samples_spread_out(4)) {
        Estimate const displacement = result.displacement(sample);
        table.add_row(std::vector<Cell>{ensemble.engine.kind, name_of(ensemble.start), ensemble.packing_fraction,
                                        ensemble.time_step, result.step(sample) * ensemble.time_step,
                                        displacement.value, displacement.error.value_or(std::nan(""))});
      }
    }
  }
  return table;
}

Table comparisons_of(std::vector<Row> const& rows) {
  Table table;
  for (char const* name : {"quantity", "start"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "time_step", "diameters", "stepped", "stepped_error", "tiled",
                           "tiled_error", "deviation", "difference", "difference_error", "exact", "exact_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  table.add_column("seeds", std::vector<std::uint64_t>{});
  double const nothing = std::nan("");
  for (Row const& row : rows) {
    auto const add = [&](char const* quantity, double diameters, Comparison const& one) {
      table.add_row(std::vector<Cell>{quantity, name_of(row.start), row.packing_fraction, row.time_step, diameters,
                                      one.by_id.value, one.by_id.error.value_or(nothing), one.by_tile.value,
                                      one.by_tile.error.value_or(nothing), one.is_known() ? one.deviation() : nothing,
                                      one.difference.value, one.difference.error.value_or(nothing), one.reference.value,
                                      one.reference.error.value_or(nothing), static_cast<std::uint64_t>(one.seeds)});
    };
    for (std::size_t k = 0; k < row.moments.size(); ++k) add("mean_displacement", row.moments[k], row.displacements[k]);
    for (std::size_t k = 0; k < quantities.size(); ++k) add(quantities[k].column, nothing, row.rates[k]);
  }
  return table;
}

void draw_curves(Study& study, std::vector<Row> const& rows) {
  Plot plot{.name = "turn_order",
            .title = "The order of the turns",
            .x = {.label = "time / (diameters per v_max)", .is_logarithmic = true},
            .y = {.label = "mean displacement / side of the box", .is_logarithmic = true},
            .key = PlotKey::outside};
  std::size_t colour = 0;
  for (Row const& row : rows) {
    if (row.time_step != study.extent().order_time_steps.front()) continue;
    for (char const* kind : {stepped, tiled}) {
      plot.curves.push_back(
          {.label = fmt::format("{} {}, {}", name_of(row.start), row.packing_fraction, kind),
           .file = "turn_order.csv",
           .x = "diameters",
           .y = "mean_displacement",
           .error = "mean_displacement_error",
           .where = {{.column = "engine", .equals = kind},
                     {.column = "start", .equals = name_of(row.start)},
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
  PageTable table{.header = {"start", "φ", "time step", "stepped", "tiled", "exact"},
                  .caption =
                      "Mean displacement over the side at the end of the runs, and (tiled − stepped) / standard "
                      "error after some times, in diameters per v_max. A star: chance explains it in less than "
                      "0.3 % of all cases."};
  for (double const moment : rows.front().moments) table.header.push_back(fmt::format("after {:.3g}", moment));
  for (Row const& row : rows) {
    std::vector<PageCell> cells = row.names();
    Comparison const& last = row.displacements.back();
    for (Estimate const& estimate : {last.by_id, last.by_tile, last.reference}) cells.emplace_back(to_text(estimate));
    for (Comparison const& one : row.displacements) cells.emplace_back(deviation_text(one));
    table.rows.push_back(std::move(cells));
  }
  return table;
}

PageTable rate_table(std::vector<Row> const& rows) {
  PageTable table{.header = {"quantity", "start", "φ", "time step", "stepped", "tiled", "difference / standard error",
                             "difference start by start, %", "exact"},
                  .caption =
                      "Over the last half of the runs. A star: chance explains it in less than 0.3 % of all "
                      "cases."};
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    for (Row const& row : rows) {
      Comparison const& one = row.rates[k];
      Estimate percent = one.relative_difference();
      percent = {.value = 100.0 * percent.value, .error = 100.0 * percent.error.value_or(0.0)};
      std::vector<PageCell> cells{quantities[k].name};
      std::ranges::copy(row.names(), std::back_inserter(cells));
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

/// Whether the means of the two orders agree within their errors, for one time step.
std::string agreement_text(std::vector<Row> const& rows, double step) {
  std::size_t count = 0;
  double squares = 0.0;
  std::vector<std::string> differing;
  auto const look = [&](std::string const& what, Row const& row, Comparison const& one) {
    if (!one.is_known()) return;
    ++count;
    squares += one.deviation() * one.deviation();
    if (!one.differs()) return;
    differing.push_back(fmt::format("{} at φ = {} {} ({:.2f} times, {:+.1f} standard errors)", what,
                                    row.packing_fraction, name_of(row.start), one.by_tile.value / one.by_id.value,
                                    one.deviation()));
  };
  for (Row const& row : rows) {
    if (row.time_step != step) continue;
    for (std::size_t k = 0; k < row.moments.size(); ++k) {
      look(fmt::format("displacement after {:.3g}", row.moments[k]), row, row.displacements[k]);
    }
    for (std::size_t k = 0; k < quantities.size(); ++k) look(quantities[k].name, row, row.rates[k]);
  }
  if (count == 0) return fmt::format("Steps of {}: too few runs to tell.", step);
  return fmt::format(
      "With steps of {}, {} of {} comparisons of displacements, pressures and collision rates agree within their "
      "errors "
      "(root mean square of the deviations: {:.2f} standard errors){}{}.",
      step, count - differing.size(), count, std::sqrt(squares / static_cast<double>(count)),
      differing.empty() ? "" : "; by more than chance explains in 0.3 % of all cases differ: ",
      fmt::join(differing, ", "));
}

/// How much the order matters beside the step itself: the largest differences over all densities for each time step.
std::string order_and_step_text(Study const& study, std::vector<Row> const& rows) {
  std::vector<std::string> parts;
  for (double const step : study.extent().order_time_steps) {
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
      "Start by start, which is sharper than the errors of the means, the order of the turns changes pressures and "
      "collision rates by at most {}.",
      fmt::join(parts, ", and "));
}

}  // namespace

void plan_turn_order(Study& study) {
  for (Orders const& orders : orders_of(study.extent())) {
    for (Ensemble const& ensemble : {orders.by_id, orders.by_tile, orders.reference}) plan(study, ensemble);
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
      "Single trajectories part after a few collisions; what is measured of them must not. Both orders, and the exact "
      "dynamics, from the same {} starts at each density, for {} diameters per v_max.",
      study.extent().order_seeds, study.extent().order_diameters));
  chapter.drawings.push_back({{"turn_order.svg"}, "Lines: stepped. Points: tiled."});
  chapter.tables.push_back(displacement_table(rows));
  chapter.tables.push_back(rate_table(rows));
  for (double const step : study.extent().order_time_steps) {
    chapter.conclusions.push_back(agreement_text(rows, step));
  }
  chapter.conclusions.push_back(order_and_step_text(study, rows));
  return chapter;
}

}  // namespace gridlock
