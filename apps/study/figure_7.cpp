#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "study/crossing.hpp"
#include "study/figures.hpp"
#include "study/mean_distance.hpp"
#include "study/physics_or_step.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

constexpr double jamming_level = 0.1;
constexpr double temperature_of_start = 0.25;  // kT/m = v_max²/4 for v_max = 1
constexpr double share_of_plateau = 0.4;       // of a plateau run that counts
constexpr double diffusive_up_to = 0.6;        // where Enskog's theory is drawn
constexpr std::array both_starts{StartKind::square, StartKind::triangular};

double radius_at(double packing_fraction, std::uint64_t disks) {
  return std::sqrt(packing_fraction / (static_cast<double>(disks) * std::numbers::pi));
}

/// What follows without simulation from the sites of a start: the plateau and the approach to it.
class Prediction {
 public:
  Prediction(PaperExtent const& extent, StartKind start) : disks_(extent.disks) {
    auto const fit = start == StartKind::square ? fit_square_lattice : fit_triangular_lattice;
    sites_ = fit(box_, extent.disks).sites;
  }

  [[nodiscard]] double plateau(double packing_fraction) const {
    return mean_distance(sites_, room_of_centres(box_, radius_at(packing_fraction, disks_)));
  }
  /// Enskog diffusion for some physical time; at short times disks still fly straight on, hence the delay.
  [[nodiscard]] double diffused(double packing_fraction, double time) const {
    double const radius = radius_at(packing_fraction, disks_);
    double const diffusion = enskog_diffusion(packing_fraction, radius, temperature_of_start);
    double const memory = diffusion / temperature_of_start;
    double const effective = time - memory * (1.0 - std::exp(-time / memory));
    return mean_distance_after_diffusion(sites_, room_of_centres(box_, radius), diffusion * effective);
  }

 private:
  Box box_;
  std::uint64_t disks_;
  std::vector<Vector> sites_;
};

/// The predictions for both starts, made once.
class Predictions {
 public:
  explicit Predictions(PaperExtent const& extent)
      : square_(extent, StartKind::square), triangular_(extent, StartKind::triangular) {}

  [[nodiscard]] Prediction const& of(StartKind start) const {
    return start == StartKind::square ? square_ : triangular_;
  }

 private:
  Prediction square_;
  Prediction triangular_;
};

/// The physical time of a number of steps of 0.1 diameters.
double time_of(std::uint64_t steps, double packing_fraction, PaperExtent const& extent) {
  return 0.1 * 2.0 * radius_at(packing_fraction, extent.disks) * static_cast<double>(steps);
}

/// Runs at low density that last until the start is forgotten.
ReplicaSet plateau_replica_set(PaperExtent const& extent, StartKind start, double packing_fraction) {
  double const radius = radius_at(packing_fraction, extent.disks);
  double const room = 1.0 - 2.0 * radius;
  double const diffusion = enskog_diffusion(packing_fraction, radius, temperature_of_start);
  double const relaxation = room * room / (std::numbers::pi * std::numbers::pi * diffusion);
  double const duration = extent.plateau_time_step * 2.0 * radius;
  constexpr double samples = 200.0;
  auto const every =
      static_cast<std::uint64_t>(std::ceil(extent.plateau_relaxations * relaxation / duration / samples));
  return {.engine = extent.engines.front(),
          .start = start,
          .packing_fraction = packing_fraction,
          .time_step = extent.plateau_time_step,
          .steps = every * static_cast<std::uint64_t>(samples),
          .sample_every = every,
          .seeds = extent.plateau_seeds};
}

std::vector<ReplicaSet> plateau_replica_sets(PaperExtent const& extent) {
  std::vector<ReplicaSet> replica_sets;
  for (double const density : extent.plateau_densities) {
    for (StartKind const start : both_starts) replica_sets.push_back(plateau_replica_set(extent, start, density));
  }
  return replica_sets;
}

Table points_table(Study const& study, Predictions const& predictions) {
  Table table;
  for (char const* name : {"engine", "start"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name :
       {"packing_fraction", "time", "mean_displacement", "mean_displacement_error", "plateau", "enskog_diffusion",
        "halted_fraction", "halted_fraction_error", "collision_rate", "collision_rate_error"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (char const* name : {"steps", "seeds", "arrested"}) table.add_column(name, std::vector<std::uint64_t>{});
  for (ReplicaSet const& replica_set : paper_replica_sets(study.extent(), study.extent().figure_7)) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    Prediction const& prediction = predictions.of(replica_set.start);
    Estimate const displacement = result.last_displacement();
    Estimate const halted = result.tail_halted_fraction(0.2);
    Estimate const collisions = result.tail_collision_rate(0.2);
    double const time = result.time(result.samples() - 1);
    double const density = replica_set.packing_fraction;
    double const nothing = std::nan("");
    table.add_row(std::vector<Cell>{
        replica_set.engine.kind, name_of(replica_set.start), density, time, displacement.value,
        displacement.error.value_or(nothing), prediction.plateau(density),
        density <= diffusive_up_to ? prediction.diffused(density, time) : nothing, halted.value,
        halted.error.value_or(nothing), collisions.value, collisions.error.value_or(nothing), replica_set.steps,
        static_cast<std::uint64_t>(result.seeds()), static_cast<std::uint64_t>(result.arrested())});
  }
  return table;
}

Table theory_table(PaperExtent const& extent, Predictions const& predictions) {
  Prediction const& square = predictions.of(StartKind::square);
  Prediction const& triangular = predictions.of(StartKind::triangular);
  std::vector<double> densities;
  for (int i = 1; i <= 39; ++i) densities.push_back(0.02 * i);
  auto const of_densities = [&](auto function) {
    std::vector<double> values;
    std::ranges::transform(densities, std::back_inserter(values), function);
    return values;
  };
  auto const diffusion = [&](Prediction const& prediction) {
    return of_densities([&](double density) {
      bool const is_fluid = density <= diffusive_up_to;
      return is_fluid ? prediction.diffused(density, time_of(extent.figure_7.steps, density, extent)) : std::nan("");
    });
  };
  Table table;
  table.add_column("packing_fraction", densities);
  table.add_column("plateau_square", of_densities([&](double density) { return square.plateau(density); }));
  table.add_column("plateau_triangular", of_densities([&](double density) { return triangular.plateau(density); }));
  table.add_column("diffusion_square", diffusion(square));
  table.add_column("diffusion_triangular", diffusion(triangular));
  table.add_column("two_random_points", of_densities([&](double density) {
                     return mean_distance_in_square(1.0 - 2.0 * radius_at(density, extent.disks));
                   }));
  return table;
}

Table plateau_table(Study const& study, Predictions const& predictions) {
  Table table;
  table.add_column("start", std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "time", "mean_displacement", "mean_displacement_error", "plateau"}) {
    table.add_column(name, std::vector<double>{});
  }
  table.add_column("seeds", std::vector<std::uint64_t>{});
  for (ReplicaSet const& replica_set : plateau_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    Estimate const displacement = result.tail_displacement(share_of_plateau);
    table.add_row(std::vector<Cell>{name_of(replica_set.start), replica_set.packing_fraction,
                                    result.time(result.samples() - 1), displacement.value,
                                    displacement.error.value_or(std::nan("")),
                                    predictions.of(replica_set.start).plateau(replica_set.packing_fraction),
                                    static_cast<std::uint64_t>(result.seeds())});
  }
  return table;
}

void draw_points(Study& study) {
  PaperExtent const& extent = study.extent();
  Plot plot{.name = "figure_7",
            .title = fmt::format("Figure 7: mean displacement after {} steps", extent.figure_7.steps),
            .x = {.label = "packing fraction φ", .least = 0.0, .most = 0.9},
            .y = {.label = "mean displacement / side of the box", .least = 0.0},
            .references = {{.at = jamming_level, .label = "10 %"}},
            .key = PlotKey::below,
            .width = 900,
            .height = 720};
  for (PaperEngine const& engine : extent.engines) {
    bool const is_first_engine = engine.kind == extent.engines.front().kind;
    for (StartKind const start : both_starts) {
      plot.curves.push_back(
          {.label = fmt::format("{} start, {}", name_of(start), engine.label),
           .file = "figure_7.csv",
           .x = "packing_fraction",
           .y = "mean_displacement",
           .error = "mean_displacement_error",
           .where = {{.column = "engine", .equals = engine.kind}, {.column = "start", .equals = name_of(start)}},
           .style = is_first_engine ? PlotStyle::line_and_points : PlotStyle::points,
           .is_open = !is_first_engine,
           .point_size = is_first_engine ? 1.0 : 1.2,
           .colour = start == StartKind::square ? 0U : 1U});
    }
  }
  std::size_t colour = 2;
  plot.curves.push_back({.label = "plateau: start site to random point, exact",
                         .file = "figure_7_theory.csv",
                         .x = "packing_fraction",
                         .y = "plateau_square",
                         .colour = colour++});
  plot.curves.push_back({.label = "Enskog diffusion for the same time, in the fluid (φ ≤ 0.6)",
                         .file = "figure_7_theory.csv",
                         .x = "packing_fraction",
                         .y = "diffusion_square",
                         .is_dashed = true,
                         .colour = colour++});
  plot.curves.push_back({.label = "longer runs, start forgotten",
                         .file = "figure_7_plateau.csv",
                         .x = "packing_fraction",
                         .y = "mean_displacement",
                         .error = "mean_displacement_error",
                         .style = PlotStyle::points,
                         .colour = colour++});
  plot.y.most = 0.6;
  constexpr double inset_width = 0.165;
  constexpr double inset_density = 0.7;
  double left = 0.05;
  for (StartKind const start : both_starts) {
    std::string const name = fmt::format("figure_7_{}", name_of(start));
    study.draw(start_state(extent, start, inset_density, study.seed(0)), {.width = inset_pixels(plot, inset_width)},
               name);
    plot.insets.push_back({.file = name + ".png", .x = left, .y = 0.16, .width = inset_width, .label = name_of(start)});
    left += inset_width + 0.03;
  }
  study.draw(plot);
}

/// A time in runs of one length.
struct SampleTime {
  PaperLength length;
  double share_of_run = 1.0;

  [[nodiscard]] double step() const { return share_of_run * static_cast<double>(length.steps); }
};

/// Early and late in the runs that have errors.
SampleTime early(PaperExtent const& extent) { return {extent.figure_6, 0.1}; }
SampleTime late(PaperExtent const& extent) { return {extent.figure_6}; }

std::string seeds_text(PaperLength const& length) {
  return length.seeds == 1 ? "1 seed" : fmt::format("{} seeds", length.seeds);
}

/// Where the curve of one engine and start falls through 10 % at a time.
Crossing crossing_at(Study const& study, PaperEngine const& engine, StartKind start, SampleTime const& sample_time) {
  std::vector<CurvePoint> points;
  for (ReplicaSet const& replica_set : paper_replica_sets(study.extent(), sample_time.length)) {
    if (replica_set.engine.kind != engine.kind || replica_set.start != start) continue;
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    auto const sample =
        static_cast<std::size_t>(std::lround(sample_time.share_of_run * static_cast<double>(result.samples() - 1)));
    Estimate const displacement = result.displacement(std::max<std::size_t>(1, sample));
    if (displacement.value > 0.0) points.push_back({.x = replica_set.packing_fraction, .y = displacement});
  }
  return find_crossing(points, jamming_level);
}

PageTable crossing_table(Study const& study) {
  PageTable table{
      .header = {"start", "engine"},
      .caption =
          "Packing fraction at which the mean displacement falls through 10 % of the side. Errors: standard error over "
          "seeds, where there are several, and uncertainty of the interpolation."};
  PaperExtent const& extent = study.extent();
  std::vector<SampleTime> sample_times{early(extent), {extent.figure_6, 0.3}, late(extent)};
  if (extent.figure_7.steps > extent.figure_6.steps) sample_times.push_back({extent.figure_7});
  for (SampleTime const& sample_time : sample_times) {
    table.header.push_back(fmt::format("after {:.0f} steps, {}", sample_time.step(), seeds_text(sample_time.length)));
  }
  for (PaperEngine const& engine : study.extent().engines) {
    for (StartKind const start : both_starts) {
      std::vector<PageCell> row{name_of(start), engine.label};
      for (SampleTime const& sample_time : sample_times) {
        row.emplace_back(crossing_text(crossing_at(study, engine, start, sample_time)));
      }
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

PaperClaim crossing_claim(Study const& study) {
  PaperEngine const& engine = study.extent().engines.front();
  SampleTime const end{study.extent().figure_7};
  Crossing const square = crossing_at(study, engine, StartKind::square, end);
  Crossing const triangular = crossing_at(study, engine, StartKind::triangular, end);
  PaperClaim claim{.where = "Figure 7",
                   .statement =
                       "With rising packing fraction the mean displacement falls through 10 % of the side of the box: "
                       "the system jams."};
  claim.measured =
      fmt::format("After {} steps ({}) the square start crosses at φ = {}, the triangular start at φ = {}.",
                  end.length.steps, seeds_text(end.length), crossing_text(square), crossing_text(triangular));
  if (end.length.seeds == 1) claim.measured += " The errors are those of the interpolation alone.";
  if (square.kind == CrossingKind::no_points || triangular.kind == CrossingKind::no_points) return claim;
  bool const is_crossed = square.kind == CrossingKind::crossed && triangular.kind == CrossingKind::crossed;
  claim.verdict = is_crossed && !square.comes_back && !triangular.comes_back ? Verdict::agrees : Verdict::differs;
  return claim;
}

/// Whether the 10 % line marks a density, or only how long one has waited.
PaperClaim duration_claim(Study const& study) {
  PaperClaim claim{
      .where = "Figure 7",
      .statement = "The density at which the curve falls below 10 % of the side marks the jamming transition."};
  PaperExtent const& extent = study.extent();
  std::string text;
  bool is_moving = false;
  for (StartKind const start : both_starts) {
    Crossing const first = early_crossing(study, extent.engines.front(), start);
    Crossing const last = late_crossing(study, extent.engines.front(), start);
    if (first.kind != CrossingKind::crossed || last.kind != CrossingKind::crossed) continue;
    double const shift = last.x - first.x;
    double const error = std::hypot(last.error(), first.error());
    is_moving = is_moving || shift > 3.0 * error;
    text += fmt::format("{} start: the crossing moves by {} from {:.0f} to {:.0f} steps. ",
                        start == StartKind::square ? "Square" : "Triangular", to_text(Estimate{shift, error}),
                        early(extent).step(), late(extent).step());
  }
  if (text.empty()) {
    claim.measured = "Not crossed both after a tenth of the runs and at their end.";
    return claim;
  }
  claim.measured =
      text + fmt::format("{} {}",
                         is_moving ? "The longer one waits, the denser a system still passes 10 %: the line measures "
                                     "slow diffusion and the length of the run, not only a density."
                                   : "No shift beyond three standard errors.",
                         "Closest packing in this box lies higher, at φ = 0.785 for the square lattice and 0.865 for "
                         "the triangular one.");
  claim.verdict = is_moving ? Verdict::differs : Verdict::undecided;
  return claim;
}

std::string deviation_text(Estimate const& measured, double exact) {
  if (!measured.error || !(*measured.error > 0.0)) return "–";
  double const deviation = (measured.value - exact) / *measured.error;
  return fmt::format("{}{:.1f}", deviation < 0.0 ? "−" : "+", std::abs(deviation));
}

PageTable plateau_comparison(Study const& study, Predictions const& predictions) {
  PageTable table{.header = {"start", "φ", "runs", "measured", "exact plateau", "deviation / standard error"},
                  .caption = fmt::format(
                      "Runs of {} relaxation times of the slowest mode of the box, of which the last {:.0f} % count; "
                      "time step {} diameters per v_max, since the plateau does not depend on it.",
                      study.extent().plateau_relaxations, 100.0 * share_of_plateau, study.extent().plateau_time_step)};
  for (ReplicaSet const& replica_set : plateau_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    Estimate const measured = result.tail_displacement(share_of_plateau);
    double const exact = predictions.of(replica_set.start).plateau(replica_set.packing_fraction);
    table.rows.push_back({name_of(replica_set.start), fmt::format("{}", replica_set.packing_fraction),
                          fmt::format("{}", result.seeds()), to_text(measured), fmt::format("{:.5f}", exact),
                          deviation_text(measured, exact)});
  }
  return table;
}

PageTable approach_comparison(Study const& study, Predictions const& predictions) {
  PageTable table{
      .header = {"engine", "start", "φ", "measured", "Enskog diffusion", "exact plateau",
                 "from the plateau / standard error"},
      .caption = fmt::format("The points of Figure 7 at low density, after {} steps: how near to the plateau they can "
                             "be after that time, by Enskog's diffusion between walls.",
                             study.extent().figure_7.steps)};
  for (ReplicaSet const& replica_set : paper_replica_sets(study.extent(), study.extent().figure_7)) {
    if (replica_set.packing_fraction > diffusive_up_to) continue;
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    Prediction const& prediction = predictions.of(replica_set.start);
    Estimate const measured = result.last_displacement();
    double const exact = prediction.plateau(replica_set.packing_fraction);
    double const time = result.time(result.samples() - 1);
    table.rows.push_back({replica_set.engine.label, name_of(replica_set.start),
                          fmt::format("{}", replica_set.packing_fraction), to_text(measured),
                          fmt::format("{:.4f}", prediction.diffused(replica_set.packing_fraction, time)),
                          fmt::format("{:.5f}", exact), deviation_text(measured, exact)});
  }
  return table;
}

PaperClaim plateau_claim(Study const& study, Predictions const& predictions) {
  PaperClaim claim{.where = "Figure 7",
                   .statement = "At low packing fractions the mean displacement levels off near 0.5 of the side."};
  bool is_within = true;
  std::string text;
  for (ReplicaSet const& replica_set : plateau_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() < 2) continue;
    Estimate const measured = result.tail_displacement(share_of_plateau);
    double const exact = predictions.of(replica_set.start).plateau(replica_set.packing_fraction);
    double const allowed = three_sigma(result.seeds() - 1) * measured.error.value_or(0.0);
    is_within = is_within && std::abs(measured.value - exact) < allowed;
    text += fmt::format("{}{} at φ = {} ({} start; exact {:.4f})", text.empty() ? "" : ", ", to_text(measured),
                        replica_set.packing_fraction, name_of(replica_set.start), exact);
  }
  if (text.empty()) {
    claim.measured = "Not measured.";
    return claim;
  }
  claim.measured = fmt::format(
      "Once the start is forgotten: {}. Nothing is fitted: the plateau is the mean distance from a start site to a "
      "point uniform in the room of the centres; for two random points of the whole box it would be {:.4f}. "
      "Disagreement would be a deviation that chance explains in less than 0.3 % of all cases (Student's t).",
      text, mean_distance_in_square(1.0));
  claim.verdict = is_within ? Verdict::agrees : Verdict::differs;
  return claim;
}

/// Replica sets that have come to a standstill, in words.
std::string standstill_text(Study const& study) {
  std::vector<std::string> parts;
  for (ReplicaSet const& replica_set : paper_replica_sets(study.extent(), study.extent().figure_7)) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0 || result.arrested() == 0) continue;
    parts.push_back(fmt::format("φ = {} {} ({} of {} runs, {:.1f} % of the moves halted)", replica_set.packing_fraction,
                                name_of(replica_set.start), result.arrested(), result.seeds(),
                                100.0 * result.tail_halted_fraction(0.2).value));
  }
  if (parts.empty()) return "No run came to a standstill: nowhere were more than 98 % of the moves halted.";
  return fmt::format(
      "Runs that came to a standstill, with more than 98 % of all moves halted over the last fifth: {}. Hard disks "
      "that move from collision to collision do not stop; at these densities the points of the figure show the finite "
      "step, not physics.",
      fmt::join(parts, "; "));
}

/// Where the points of the figure have their errors from.
std::string errors_text(PaperExtent const& extent) {
  if (extent.figure_7.seeds > 1) {
    return fmt::format("error bars are standard errors over {} seeds", extent.figure_7.seeds);
  }
  return fmt::format(
      "each point is one run, which has no error over seeds: what compares points rests on {} seeds and {} steps",
      extent.figure_6.seeds, extent.figure_6.steps);
}

}  // namespace

void plan_figure_7(Study& study) {
  PaperExtent const& extent = study.extent();
  for (PaperLength const& length : {extent.figure_6, extent.figure_7}) {
    for (ReplicaSet const& replica_set : paper_replica_sets(extent, length)) plan(study, replica_set);
  }
  for (ReplicaSet const& replica_set : plateau_replica_sets(study.extent())) plan(study, replica_set);
}

Chapter figure_7(Study& study) {
  PaperExtent const& extent = study.extent();
  Predictions const predictions(extent);
  study.write(points_table(study, predictions), "figure_7.csv");
  study.write(theory_table(extent, predictions), "figure_7_theory.csv");
  study.write(plateau_table(study, predictions), "figure_7_plateau.csv");
  draw_points(study);

  Chapter chapter{.title = "Figure 7: displacement against packing fraction"};
  chapter.introduction.push_back(
      fmt::format("The mean displacement of {} disks after {} steps, for square and triangular starts; {}. Insets: the "
                  "two starts at φ = 0.7.",
                  extent.disks, extent.figure_7.steps, errors_text(extent)));
  std::string caption =
      "Mean displacement at the end of the run; lines and filled symbols: the paper's rule. The plateau is no fit: it "
      "is the mean distance from a site of the "
      "start to a random point, exactly. The triangular start has a few sites too many, which stay empty. Points "
      "below the plateau at low density have had too little time: Enskog's diffusion between walls for the same time "
      "gives the dashed curve.";
  if (double const densest = extent.figure_7.densest_of_others; densest < 1.0) {
    caption += fmt::format(
        " Above φ = {} the paper's rule alone was run: other dynamics collide too often there for a quick study.",
        densest);
  }
  chapter.drawings.push_back({{"figure_7.svg"}, caption});
  chapter.claims.push_back(plateau_claim(study, predictions));
  chapter.claims.push_back(crossing_claim(study));
  chapter.claims.push_back(duration_claim(study));
  chapter.tables.push_back(crossing_table(study));
  chapter.tables.push_back(plateau_comparison(study, predictions));
  chapter.tables.push_back(approach_comparison(study, predictions));
  chapter.conclusions.push_back(standstill_text(study));
  chapter.conclusions.push_back(
      "For comparison: an infinite system of hard disks freezes between φ = 0.700 (liquid) and 0.720 (hexatic and "
      "solid), Engel et al. 2013, doi:10.1103/PhysRevE.87.042134. That the 10 % line is crossed hereabouts is what one "
      "expects of a crystal, whose disks keep their neighbours; the lattices themselves are jammed only when close "
      "packed.");
  return chapter;
}

Crossing early_crossing(Study const& study, PaperEngine const& engine, StartKind start) {
  return crossing_at(study, engine, start, early(study.extent()));
}

Crossing late_crossing(Study const& study, PaperEngine const& engine, StartKind start) {
  return crossing_at(study, engine, start, late(study.extent()));
}

std::string crossing_text(Crossing const& crossing) {
  switch (crossing.kind) {
    case CrossingKind::crossed:
      return fmt::format("{} (between {} and {}{})", to_text(Estimate{crossing.x, crossing.error()}),
                         crossing.last_above, crossing.first_below,
                         crossing.comes_back ? "; a denser point lies above it again" : "");
    case CrossingKind::stays_above:
      return "no crossing: above 10 % everywhere";
    case CrossingKind::starts_below:
      return "no crossing: below 10 % from the lowest density on";
    case CrossingKind::no_points:
      break;
  }
  return "not measured";
}

}  // namespace gridlock
