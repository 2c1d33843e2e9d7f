#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "study/falling.hpp"
#include "study/figures.hpp"

namespace gridlock {

namespace {

/// The densities of the fan: on the square lattice as far as it goes, beyond on the triangular one.
std::vector<ReplicaSet> fan(PaperExtent const& extent) {
  constexpr double closest_square_packing = 0.25 * std::numbers::pi;
  std::vector<ReplicaSet> replica_sets;
  for (PaperEngine const& engine : extent.engines) {
    for (double const density : extent.fan_densities) {
      StartKind const start = density < closest_square_packing ? StartKind::square : StartKind::triangular;
      replica_sets.push_back(paper_replica_set(extent.figure_6, engine, start, density));
    }
  }
  return replica_sets;
}

Table series_of(Study const& study, std::vector<ReplicaSet> const& replica_sets) {
  Table table;
  for (char const* name : {"engine", "start"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "step", "time", "mean_displacement", "mean_displacement_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  table.add_column("seeds", std::vector<std::uint64_t>{});
  for (ReplicaSet const& replica_set : replica_sets) {
    ReplicaResult const result(study, replica_set);
    // A point every two percent is enough.
    for (std::size_t const sample : result.samples_spread_out(50)) {
      Estimate const displacement = result.displacement(sample);
      table.add_row(std::vector<Cell>{replica_set.engine.kind, name_of(replica_set.start), replica_set.packing_fraction,
                                      result.step(sample), result.time(sample), displacement.value,
                                      displacement.error.value_or(std::nan("")),
                                      static_cast<std::uint64_t>(result.seeds())});
    }
  }
  return table;
}

/// The densities at the ends of the curves of the first engine, moved apart where they would cover each other.
std::vector<PlotLabel> end_labels(Study const& study, std::vector<ReplicaSet> const& replica_sets,
                                  bool is_logarithmic) {
  constexpr double least_distance = 0.045;  // of the height of the plot
  std::vector<double> const& densities = study.extent().fan_densities;
  double const steps = static_cast<double>(study.extent().figure_6.steps);
  auto const on_axis = [&](double y) { return is_logarithmic ? std::log(y) : y; };
  std::vector<PlotLabel> labels;
  double least = is_logarithmic ? HUGE_VAL : 0.0;
  double most = -HUGE_VAL;
  for (ReplicaSet const& replica_set : replica_sets) {
    ReplicaResult const result(study, replica_set);
    if (replica_set.engine.kind != study.extent().engines.front().kind || result.seeds() == 0) continue;
    double const last = result.last_displacement().value;
    if (!(last > 0.0)) continue;
    double const first = result.displacement(std::min<std::size_t>(1, result.samples() - 1)).value;
    if (is_logarithmic && first > 0.0) least = std::min(least, on_axis(first));
    most = std::max(most, on_axis(last));
    auto const place = std::ranges::find(densities, replica_set.packing_fraction) - densities.begin();
    labels.push_back({.text = fmt::format("φ = {:.2f}{}", replica_set.packing_fraction,
                                          replica_set.start == StartKind::triangular ? " tri." : ""),
                      .x = is_logarithmic ? 1.05 * steps : 1.01e-3 * steps,
                      .y = on_axis(last),
                      .colour = static_cast<std::size_t>(place)});
  }
  std::ranges::sort(labels, {}, &PlotLabel::y);
  double lowest = least;
  for (PlotLabel& label : labels) {
    label.y = std::max(label.y, lowest);
    lowest = label.y + least_distance * (most - least);
    if (is_logarithmic) label.y = std::exp(label.y);
  }
  return labels;
}

void draw_fan(Study& study, std::vector<ReplicaSet> const& replica_sets, bool is_logarithmic) {
  Plot plot{
      .name = is_logarithmic ? "figure_6_logarithmic" : "figure_6",
      .title = is_logarithmic ? "Figure 6 again, both axes logarithmic" : "Figure 6: mean displacement against time",
      .x = {.label = is_logarithmic ? "time steps" : "time / 1000 steps", .is_logarithmic = is_logarithmic},
      .y = {.label = "mean displacement / side of the box", .is_logarithmic = is_logarithmic},
      .references = {{.at = 0.1, .label = "10 %", .label_place = 0.0}},
      .key = PlotKey::top_left,
      .colours = PlotColours::sequential};
  // Room at the right for the densities.
  double const steps = static_cast<double>(study.extent().figure_6.steps);
  plot.x.least = is_logarithmic ? static_cast<double>(study.extent().figure_6.sample_every) : 0.0;
  plot.x.most = is_logarithmic ? 4.0 * steps : 1.2e-3 * steps;
  if (!is_logarithmic) plot.y.least = 0.0;
  for (PaperEngine const& engine : study.extent().engines) {
    bool const is_first = &engine == &study.extent().engines.front();
    plot.formulas.push_back({.label = engine.label, .formula = "NaN", .is_dashed = !is_first});
  }
  std::vector<double> const& densities = study.extent().fan_densities;
  for (ReplicaSet const& replica_set : replica_sets) {
    if (ReplicaResult(study, replica_set).seeds() == 0) continue;
    bool const is_first_engine = replica_set.engine.kind == study.extent().engines.front().kind;
    auto const place = std::ranges::find(densities, replica_set.packing_fraction) - densities.begin();
    plot.curves.push_back(
        {.file = "figure_6.csv",
         .x = "step",
         .y = "mean_displacement",
         .error = "mean_displacement_error",
         .where = {{.column = "engine", .equals = replica_set.engine.kind},
                   {.column = "start", .equals = name_of(replica_set.start)},
                   {.column = "packing_fraction", .equals = fmt::format("{}", replica_set.packing_fraction)}},
         .is_dashed = !is_first_engine,
         .colour = static_cast<std::size_t>(place),
         .x_factor = is_logarithmic ? 1.0 : 1e-3});
  }
  if (plot.curves.empty()) return;
  plot.labels = end_labels(study, replica_sets, is_logarithmic);
  study.draw(plot);
}

/// Whether the final displacements fall from each density to the next, as far as the errors can tell.
PaperClaim order_claim(Study const& study, std::vector<ReplicaSet> const& replica_sets) {
  PaperClaim claim{.where = "Figure 6",
                   .statement =
                       "The denser the system, the less the disks move away from where they started; dense systems "
                       "stay near their start for the whole run."};
  constexpr double near = 0.1;  // of the side
  std::string text;
  std::vector<MeanOfRuns> values;
  for (ReplicaSet const& replica_set : replica_sets) {
    if (replica_set.engine.kind != study.extent().engines.front().kind) continue;
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    values.push_back({.mean = result.last_displacement(), .runs = result.seeds()});
    text += fmt::format("{}{} at φ = {}", text.empty() ? "" : ", ", to_text(values.back().mean),
                        replica_set.packing_fraction);
  }
  claim.measured = fmt::format(
      "After {} steps, in sides of the box: {}. Disorder would be a rise from any density to a higher one that chance "
      "explains in less than 0.3 % of all cases; staying near means less than 10 % of the side.",
      study.extent().figure_6.steps, text);
  claim.verdict = verdict_on_fall(values, near);
  return claim;
}

}  // namespace

void plan_figure_6(Study& study) {
  for (ReplicaSet const& replica_set : fan(study.extent())) plan(study, replica_set);
}

Chapter figure_6(Study& study) {
  std::vector<ReplicaSet> const replica_sets = fan(study.extent());
  study.write(series_of(study, replica_sets), "figure_6.csv");
  draw_fan(study, replica_sets, false);
  draw_fan(study, replica_sets, true);

  Chapter chapter{.title = "Figure 6: how far the disks have come"};
  chapter.introduction.push_back(
      fmt::format("The mean distance of {} disks from where they started, over the side of the box, against time, for "
                  "{} steps of 0.1 diameters per v_max. Starts on the square lattice up to its closest packing π/4 = "
                  "0.785, above on the triangular one. Bands are one standard error over {} seeds.",
                  study.extent().disks, study.extent().figure_6.steps, study.extent().figure_6.seeds));
  std::string caption =
      "Mean displacement against time; each curve ends beside its packing fraction (tri.: triangular start).";
  for (std::size_t k = 1; k < study.extent().engines.size(); ++k) {
    caption +=
        fmt::format(" Dashed: {}, from the same starts for the same physical time.", study.extent().engines[k].label);
  }
  chapter.drawings.push_back({{"figure_6.svg"}, caption});
  chapter.drawings.push_back({{"figure_6_logarithmic.svg"},
                              "The same on logarithmic axes, which show what the dense systems do: they rattle in "
                              "their cages, and most still creep on."});
  chapter.claims.push_back(order_claim(study, replica_sets));
  return chapter;
}

}  // namespace gridlock
