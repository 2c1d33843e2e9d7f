#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "study/figures.hpp"
#include "study/physics_or_step.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

char const* name_of(Contact contact) { return contact == Contact::always ? "always" : "approaching"; }

char const* name_of(Sites sites) {
  switch (sites) {
    case Sites::fitted:
      return "fitted";
    case Sites::to_walls:
      return "square, stretched to the walls";
    case Sites::perfect:
      break;
  }
  return "triangular, unstretched";
}

ReplicaSet choice_replica_set(PaperExtent const& extent, StartKind start, double density, double time_step) {
  return sampled_evenly({.engine = extent.engines.front(),
                         .start = start,
                         .packing_fraction = density,
                         .time_step = time_step,
                         .seeds = extent.choice_seeds},
                        extent.choice_diameters, 100);
}

/// Densities and starts, square before triangular.
std::vector<std::pair<StartKind, double>> starts_of(PaperExtent const& extent) {
  std::vector<std::pair<StartKind, double>> starts;
  for (double const density : extent.choice_square_densities) starts.emplace_back(StartKind::square, density);
  for (double const density : extent.choice_triangular_densities) starts.emplace_back(StartKind::triangular, density);
  return starts;
}

/// The same start without a time step; its samples are as far apart as with the usual one.
std::optional<ReplicaSet> reference_replica_set(PaperExtent const& extent, StartKind start, double density) {
  if (!extent.choice_reference) return std::nullopt;
  ReplicaSet replica_set = choice_replica_set(extent, start, density, usual_time_step);
  replica_set.engine = *extent.choice_reference;
  return replica_set;
}

/// What time steps are compared with: the dynamics without one, or else the finest.
ReplicaSet baseline_replica_set(PaperExtent const& extent, StartKind start, double density) {
  double const finest = std::ranges::min(extent.choice_time_steps);
  return reference_replica_set(extent, start, density).value_or(choice_replica_set(extent, start, density, finest));
}

std::string name_of_baseline(PaperExtent const& extent) {
  return extent.choice_reference ? extent.choice_reference->label : "the finest step";
}

bool has_steps(PaperExtent const& extent, ReplicaSet const& replica_set) {
  return !extent.choice_reference || replica_set.engine.kind != extent.choice_reference->kind;
}

/// Every time step under both contact rules, after the reference.
std::vector<ReplicaSet> rule_replica_sets(PaperExtent const& extent) {
  std::vector<ReplicaSet> replica_sets;
  for (auto const& [start, density] : starts_of(extent)) {
    if (auto const reference = reference_replica_set(extent, start, density)) replica_sets.push_back(*reference);
    for (Contact const contact : {Contact::always, Contact::approaching}) {
      for (double const time_step : extent.choice_time_steps) {
        ReplicaSet replica_set = choice_replica_set(extent, start, density, time_step);
        replica_set.contact = contact;
        replica_sets.push_back(replica_set);
      }
    }
  }
  return replica_sets;
}

/// The starts on other sites, with the fitted ones beside them.
std::vector<ReplicaSet> site_replica_sets(PaperExtent const& extent) {
  std::vector<ReplicaSet> replica_sets;
  for (auto const& [start, density] : starts_of(extent)) {
    for (Sites const sites : {Sites::fitted, start == StartKind::square ? Sites::to_walls : Sites::perfect}) {
      ReplicaSet replica_set = choice_replica_set(extent, start, density, usual_time_step);
      replica_set.sites = sites;
      replica_sets.push_back(replica_set);
    }
  }
  return replica_sets;
}

Table table_of(Study const& study) {
  Table table;
  for (char const* name : {"engine", "start", "sites", "contact"}) table.add_column(name, std::vector<std::string>{});
  for (char const* name : {"packing_fraction", "time_step", "time", "mean_displacement", "mean_displacement_error",
                           "halted_fraction", "collision_rate"}) {
    table.add_column(name, std::vector<double>{});
  }
  for (char const* name : {"seeds", "arrested"}) table.add_column(name, std::vector<std::uint64_t>{});
  std::vector<ReplicaSet> replica_sets = rule_replica_sets(study.extent());
  for (ReplicaSet const& replica_set : site_replica_sets(study.extent())) {
    if (replica_set.sites != Sites::fitted) replica_sets.push_back(replica_set);
  }
  for (ReplicaSet const& replica_set : replica_sets) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    Estimate const displacement = result.last_displacement();
    bool const steps = has_steps(study.extent(), replica_set);
    table.add_row(std::vector<Cell>{replica_set.engine.kind, gridlock::name_of(replica_set.start),
                                    name_of(replica_set.sites), steps ? name_of(replica_set.contact) : "none",
                                    replica_set.packing_fraction, steps ? replica_set.time_step : 0.0,
                                    result.time(result.samples() - 1), displacement.value,
                                    displacement.error.value_or(std::nan("")), result.tail_halted_fraction(0.2).value,
                                    result.tail_collision_rate(0.2).value, static_cast<std::uint64_t>(result.seeds()),
                                    static_cast<std::uint64_t>(result.arrested())});
  }
  return table;
}

std::string arrest_text(ReplicaResult const& result) {
  if (result.arrested() == 0) return "none";
  return fmt::format("{} of {}", result.arrested(), result.seeds());
}

PageTable rule_table(Study const& study) {
  PageTable table{.header = {"start", "φ", "rule", "time step", "mean displacement", "halted moves",
                             "collisions per disk and time", "standstill"},
                  .caption = fmt::format(
                      "After {} diameters per v_max of physical time, {} seeds. Halted moves and collisions over the "
                      "last fifth of the run; a smaller step is halted less often for the same physics, so compare "
                      "the collision rate.",
                      study.extent().choice_diameters, study.extent().choice_seeds)};
  for (ReplicaSet const& replica_set : rule_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    bool const steps = has_steps(study.extent(), replica_set);
    table.rows.push_back({gridlock::name_of(replica_set.start), fmt::format("{}", replica_set.packing_fraction),
                          steps ? name_of(replica_set.contact) : replica_set.engine.label,
                          steps ? fmt::format("{}", replica_set.time_step) : "none",
                          to_text(result.last_displacement()),
                          steps ? fmt::format("{:.1f} %", 100.0 * result.tail_halted_fraction(0.2).value) : "–",
                          fmt::format("{:.0f}", result.tail_collision_rate(0.2).value), arrest_text(result)});
  }
  return table;
}

PageTable site_table(Study const& study) {
  PageTable table{
      .header = {"start", "φ", "sites", "mean displacement", "standstill"},
      .caption = fmt::format("The same physical time, time step {}, contact = \"always\". Fitted: the square lattice "
                             "centred in its cells; the triangular one stretched to fill the box.",
                             usual_time_step)};
  for (ReplicaSet const& replica_set : site_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    table.rows.push_back({gridlock::name_of(replica_set.start), fmt::format("{}", replica_set.packing_fraction),
                          name_of(replica_set.sites), to_text(result.last_displacement()), arrest_text(result)});
  }
  return table;
}

void draw_rules(Study& study) {
  Plot plot{.name = "open_choices",
            .title = "Time step and contact rule",
            .x = {.label = "time step / (diameters per v_max)"},
            .y = {.label = "mean displacement / side of the box", .is_logarithmic = true},
            .key = PlotKey::outside};
  std::vector<std::string> rules{name_of(Contact::always), name_of(Contact::approaching)};
  if (study.extent().choice_reference) rules.emplace_back("none");
  std::size_t colour = 0;
  for (auto const& [start, density] : starts_of(study.extent())) {
    for (std::string const& rule : rules) {
      bool const is_named = rule == rules.front();
      plot.curves.push_back({.label = is_named ? fmt::format("{} {}", gridlock::name_of(start), density) : "",
                             .file = "open_choices.csv",
                             .x = "time_step",
                             .y = "mean_displacement",
                             .error = "mean_displacement_error",
                             .where = {{.column = "start", .equals = gridlock::name_of(start)},
                                       {.column = "packing_fraction", .equals = fmt::format("{}", density)},
                                       {.column = "contact", .equals = rule},
                                       {.column = "sites", .equals = name_of(Sites::fitted)}},
                             .style = rule == "none" ? PlotStyle::points : PlotStyle::line_and_points,
                             .is_dashed = rule == name_of(Contact::approaching),
                             .colour = colour});
    }
    ++colour;
  }
  for (Contact const contact : {Contact::always, Contact::approaching}) {
    plot.formulas.push_back({.label = fmt::format("contact: {}", name_of(contact)),
                             .formula = "NaN",
                             .is_dashed = contact == Contact::approaching});
  }
  if (study.extent().choice_reference) {
    plot.references.push_back({.at = 0.0, .label = study.extent().choice_reference->label, .is_vertical = true});
  }
  double least = 1.0;
  double most = 0.0;
  for (ReplicaSet const& replica_set : rule_replica_sets(study.extent())) {
    ReplicaResult const result(study, replica_set);
    if (result.seeds() == 0) continue;
    least = std::min(least, result.last_displacement().value);
    most = std::max(most, result.last_displacement().value);
  }
  // The dynamics without a time step is at 0, a little inside the frame.
  plot.x.most = 1.1 * std::ranges::max(study.extent().choice_time_steps);
  plot.x.least = -0.1 * std::ranges::max(study.extent().choice_time_steps);
  // Whole decades would leave most of the plot empty.
  if (least > 0.0 && most > least) {
    plot.y.least = 0.5 * least;
    plot.y.most = 1.6 * most;
  }
  study.draw(plot);
}

/// How far apart two displacements are, in standard errors; absent where the errors are not known.
std::optional<double> distance_in_errors(Estimate const& a, Estimate const& b) {
  double const error = std::hypot(a.error.value_or(0.0), b.error.value_or(0.0));
  if (!(error > 0.0)) return std::nullopt;
  return std::abs(a.value - b.value) / error;
}

/// The largest difference among pairs of replica sets that differ in one choice.
class LargestDifference {
 public:
  void compare(Study const& study, ReplicaSet const& a, ReplicaSet const& b) {
    ReplicaResult const first(study, a);
    ReplicaResult const second(study, b);
    if (first.seeds() < 2 || second.seeds() < 2) return;
    Estimate const here = first.last_displacement();
    Estimate const there = second.last_displacement();
    auto const distance = distance_in_errors(here, there);
    if (!distance) return;
    ++pairs_;
    double const ratio = std::max(here.value, there.value) / std::min(here.value, there.value);
    if (*distance > three_sigma(first.seeds() + second.seeds() - 2)) ++significant_;
    if (ratio <= ratio_) return;
    ratio_ = ratio;
    text_ = fmt::format("{} against {} ({} start, φ = {}; a factor {:.2g}, {:.1f} standard errors)", to_text(here),
                        to_text(there), gridlock::name_of(a.start), a.packing_fraction, ratio, *distance);
  }

  [[nodiscard]] std::string text() const {
    if (pairs_ == 0) return "too few runs to tell";
    return fmt::format(
        "{} of {} comparisons differ by more than chance does in 0.3 % of all cases; the largest ratio is {}",
        significant_, pairs_, text_);
  }

 private:
  std::size_t pairs_ = 0;
  std::size_t significant_ = 0;
  double ratio_ = 0.0;
  std::string text_;
};

/// The collision rates as multiples of the baseline's: the most direct sign that the step changes the dynamics, and one
/// that needs no long average.
std::string collision_text(Study const& study) {
  PaperExtent const& extent = study.extent();
  std::vector<std::string> parts;
  for (auto const& [start, density] : starts_of(extent)) {
    ReplicaResult const baseline(study, baseline_replica_set(extent, start, density));
    if (baseline.seeds() == 0) continue;
    std::vector<std::string> ratios;
    for (double const time_step : extent.choice_time_steps) {
      ReplicaResult const result(study, choice_replica_set(extent, start, density, time_step));
      if (result.seeds() == 0) continue;
      double const ratio = result.tail_collision_rate(0.2).value / baseline.tail_collision_rate(0.2).value;
      ratios.push_back(fmt::format("{:.2f}", ratio));
    }
    parts.push_back(fmt::format("{} at φ = {} ({})", fmt::join(ratios, ", "), density, gridlock::name_of(start)));
  }
  if (parts.empty()) return "";
  return fmt::format(" Collision rates with steps {}, as multiples of that of {}: {}.",
                     fmt::join(extent.choice_time_steps, ", "), name_of_baseline(extent), fmt::join(parts, "; "));
}

std::string time_step_conclusion(Study const& study) {
  PaperExtent const& extent = study.extent();
  LargestDifference difference;
  for (auto const& [start, density] : starts_of(extent)) {
    ReplicaSet const baseline = baseline_replica_set(extent, start, density);
    for (double const time_step : extent.choice_time_steps) {
      ReplicaSet const replica_set = choice_replica_set(extent, start, density, time_step);
      bool const is_baseline = replica_set.engine.kind == baseline.engine.kind && time_step == baseline.time_step;
      if (!is_baseline) difference.compare(study, baseline, replica_set);
    }
  }
  return fmt::format("Time step with \"always\", against {}: {}.{}", name_of_baseline(extent), difference.text(),
                     collision_text(study));
}

std::string contact_conclusion(Study const& study) {
  LargestDifference difference;
  std::size_t arrested_always = 0;
  std::size_t arrested_approaching = 0;
  std::size_t runs = 0;
  for (ReplicaSet const& replica_set : rule_replica_sets(study.extent())) {
    if (!has_steps(study.extent(), replica_set)) continue;
    ReplicaResult const result(study, replica_set);
    if (replica_set.contact == Contact::always) {
      arrested_always += result.arrested();
      runs += result.seeds();
      ReplicaSet other = replica_set;
      other.contact = Contact::approaching;
      difference.compare(study, replica_set, other);
    } else {
      arrested_approaching += result.arrested();
    }
  }
  return fmt::format(
      "Contact rule, \"always\" against \"approaching\": {}. Of {} runs each, {} came to a standstill with \"always\" "
      "and {} with \"approaching\": there halted disks that do not approach keep their velocities, try the same "
      "blocked displacement again, and whole systems freeze although nothing is jammed.",
      difference.text(), runs, arrested_always, arrested_approaching);
}

std::string site_conclusion(Study const& study) {
  LargestDifference difference;
  std::vector<ReplicaSet> const replica_sets = site_replica_sets(study.extent());
  for (std::size_t i = 0; i + 1 < replica_sets.size(); i += 2)
    difference.compare(study, replica_sets[i], replica_sets[i + 1]);
  return fmt::format("Sites of the lattice in the box: {}.", difference.text());
}

}  // namespace

void plan_open_choices(Study& study) {
  for (ReplicaSet const& replica_set : rule_replica_sets(study.extent())) plan(study, replica_set);
  for (ReplicaSet const& replica_set : site_replica_sets(study.extent())) plan(study, replica_set);
}

Chapter open_choices(Study& study) {
  study.write(table_of(study), "open_choices.csv");
  draw_rules(study);
  Chapter chapter{.title = "What the paper leaves open, and how much it matters"};
  chapter.introduction.push_back(
      "The rule does not fix the length of the time step, whether a halted pair collides when it is already receding, "
      "or how a lattice is fitted to the box. Each is varied here with everything else as in the figures.");
  chapter.drawings.push_back({{"open_choices.svg"},
                              "Mean displacement after the same physical time against the time step, for both contact "
                              "rules (dashed: \"approaching\"). At 0: without a time step."});
  chapter.tables.push_back(rule_table(study));
  chapter.tables.push_back(site_table(study));
  chapter.conclusions = {time_step_conclusion(study), contact_conclusion(study), site_conclusion(study)};
  return chapter;
}

std::vector<ContactsBesideExact> contacts_beside_exact(Study const& study) {
  PaperExtent const& extent = study.extent();
  auto const result_of = [](ReplicaResult const& result) -> ContactResult {
    return {.arrested = result.arrested(),
            .runs = result.seeds(),
            .displacement = result.last_displacement(),
            .collision_rate = result.tail_collision_rate(0.2).value};
  };
  std::vector<ContactsBesideExact> contacts;
  for (auto const& [start, density] : starts_of(extent)) {
    auto const reference = reference_replica_set(extent, start, density);
    for (double const time_step : extent.choice_time_steps) {
      ReplicaSet replica_set = choice_replica_set(extent, start, density, time_step);
      ReplicaResult const always(study, replica_set);
      replica_set.contact = Contact::approaching;
      ReplicaResult const approaching(study, replica_set);
      if (always.seeds() == 0 || approaching.seeds() == 0) continue;
      contacts.push_back({.start = start,
                          .packing_fraction = density,
                          .time_step = time_step,
                          .always = result_of(always),
                          .approaching = result_of(approaching)});
      if (!reference || engine_record(reference->engine.kind).has_time_step) continue;
      ReplicaResult const exact(study, *reference);
      if (exact.seeds() > 0) contacts.back().exact = result_of(exact);
    }
  }
  return contacts;
}

}  // namespace gridlock
