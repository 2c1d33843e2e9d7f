#include "study/physics_or_step.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "study/figures.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

double error_of(RuleBesideExact const& point) {
  return std::hypot(point.rule.error.value_or(0.0), point.exact.error.value_or(0.0));
}

double deviation_of(RuleBesideExact const& point) { return (point.rule.value - point.exact.value) / error_of(point); }

/// Whether chance explains the difference in less than 0.3 % of all cases.
bool differs(RuleBesideExact const& point) {
  return std::abs(deviation_of(point)) > three_sigma(2 * (point.seeds - 1));
}

double ratio_of(RuleBesideExact const& point) { return point.rule.value / point.exact.value; }

std::optional<PaperEngine> exact_engine(PaperExtent const& extent) {
  if (!engine_record(extent.engines.front().kind).has_time_step) return std::nullopt;
  for (PaperEngine const& engine : extent.engines) {
    if (!engine_record(engine.kind).has_time_step) return engine;
  }
  return std::nullopt;
}

std::vector<RuleBesideExact> points_of(Study const& study, PaperEngine const& exact) {
  std::vector<RuleBesideExact> points;
  PaperLength const& length = study.extent().figure_6;
  for (ReplicaSet const& replica_set : paper_replica_sets(study.extent(), length)) {
    if (replica_set.engine.kind != study.extent().engines.front().kind) continue;
    ReplicaResult const rule(study, replica_set);
    ReplicaResult const without_step(study,
                                     paper_replica_set(length, exact, replica_set.start, replica_set.packing_fraction));
    if (rule.seeds() < 2 || without_step.seeds() < 2) continue;
    points.push_back({.start = replica_set.start,
                      .packing_fraction = replica_set.packing_fraction,
                      .rule = rule.last_displacement(),
                      .exact = without_step.last_displacement(),
                      .seeds = std::min(rule.seeds(), without_step.seeds())});
  }
  return points;
}

StepEvidence evidence_of(Study const& study, PaperEngine const& exact) {
  PaperEngine const& rule = study.extent().engines.front();
  StepEvidence evidence{.steps = study.extent().figure_6.steps,
                        .points = points_of(study, exact),
                        .contacts = contacts_beside_exact(study)};
  for (StartKind const start : {StartKind::square, StartKind::triangular}) {
    evidence.lines.push_back({.start = start,
                              .rule_early = early_crossing(study, rule, start),
                              .rule_late = late_crossing(study, rule, start),
                              .exact_early = early_crossing(study, exact, start),
                              .exact_late = late_crossing(study, exact, start)});
  }
  return evidence;
}

PageTable point_table(StepEvidence const& evidence) {
  PageTable table{
      .header = {"start", "φ", "the paper's rule", "exact dynamics", "ratio", "difference / standard error"},
      .caption = fmt::format("Mean displacement over the side after the physical time of {} steps. A star: chance "
                             "explains it in less than 0.3 % of all cases.",
                             evidence.steps)};
  for (RuleBesideExact const& point : evidence.points) {
    table.rows.push_back({name_of(point.start), fmt::format("{}", point.packing_fraction), to_text(point.rule),
                          to_text(point.exact), fmt::format("{:.2f}", ratio_of(point)),
                          fmt::format("{:+.1f}{}", deviation_of(point), differs(point) ? " *" : "")});
  }
  return table;
}

std::string point_text(std::vector<RuleBesideExact> const& points) {
  if (points.empty()) return "Too few runs to tell.";
  std::vector<std::string> differing;
  std::size_t behind = 0;
  for (RuleBesideExact const& point : points) {
    if (point.rule.value < point.exact.value) ++behind;
    if (!differs(point)) continue;
    differing.push_back(fmt::format("φ = {} {} ({:.2f} times as far as exact disks)", point.packing_fraction,
                                    name_of(point.start), ratio_of(point)));
  }
  std::string const sides =
      fmt::format(" The rule is behind the exact disks at {} of {} points.", behind, points.size());
  if (differing.empty()) {
    return fmt::format(
               "At none of the {} points do the rule and the exact dynamics differ by more than chance explains "
               "(0.3 %).",
               points.size()) +
           sides;
  }
  return fmt::format(
             "At {} of {} points the rule and the exact dynamics agree as far as the errors tell. They differ, by more "
             "than chance explains in 0.3 % of all cases, at {}: there the rule's points show the finite step.",
             points.size() - differing.size(), points.size(), fmt::join(differing, ", ")) +
         sides;
}

bool is_crossed(Crossing const& crossing) { return crossing.kind == CrossingKind::crossed; }

Estimate difference_of(Crossing const& a, Crossing const& b) {
  return {.value = a.x - b.x, .error = std::hypot(a.error(), b.error())};
}

constexpr double errors_that_count = 3.0;

bool is_beyond_error(Estimate const& difference) {
  return std::abs(difference.value) > errors_that_count * difference.error.value_or(0.0);
}

std::string movement_text(Crossing const& early, Crossing const& late) {
  if (!is_crossed(early) || !is_crossed(late)) return "not known";
  return to_text(difference_of(late, early));
}

/// Where the line is crossed, and whether by the rule alone.
std::string line_text(std::vector<LineBesideExact> const& lines) {
  std::vector<std::string> sentences;
  for (LineBesideExact const& line : lines) {
    std::string sentence = fmt::format("From the {} start: {} under the rule, {} by exact disks", name_of(line.start),
                                       crossing_text(line.rule_late), crossing_text(line.exact_late));
    if (is_crossed(line.rule_late) && is_crossed(line.exact_late)) {
      Estimate const shift = difference_of(line.rule_late, line.exact_late);
      sentence += fmt::format("; the difference, {}, is {} three standard errors", to_text(shift),
                              is_beyond_error(shift) ? "beyond" : "within");
    }
    sentences.push_back(std::move(sentence));
  }
  return fmt::format("{}.", fmt::join(sentences, ". "));
}

std::string crossing_verdict(std::vector<LineBesideExact> const& lines) {
  auto const count = [&](Crossing LineBesideExact::*which) {
    return static_cast<std::size_t>(
        std::ranges::count_if(lines, [&](LineBesideExact const& line) { return is_crossed(line.*which); }));
  };
  std::size_t const by_rule = count(&LineBesideExact::rule_late);
  std::size_t const by_exact = count(&LineBesideExact::exact_late);
  if (by_rule == 0 && by_exact == 0) return "Neither crosses it.";
  if (by_rule == 0)
    return "Exact disks cross it, those under the rule do not: that it is not crossed is the time step.";
  if (by_exact == 0)
    return "Exact disks do not cross it: that it is crossed under the rule is the time step, not physics.";
  if (by_rule == lines.size() && by_exact == lines.size()) {
    return "Exact disks cross it, too: that it is crossed is physics, with or without a step.";
  }
  return fmt::format("The rule crosses it from {} and exact disks from {} of {} starts: not all of it is physics.",
                     by_rule, by_exact, lines.size());
}

std::string movement_verdict(std::vector<LineBesideExact> const& lines) {
  std::vector<std::string> parts;
  std::size_t known = 0;
  std::size_t moving = 0;
  for (LineBesideExact const& line : lines) {
    parts.push_back(fmt::format("{} under the rule and {} for exact disks ({})",
                                movement_text(line.rule_early, line.rule_late),
                                movement_text(line.exact_early, line.exact_late), name_of(line.start)));
    if (!is_crossed(line.exact_early) || !is_crossed(line.exact_late)) continue;
    ++known;
    if (is_beyond_error(difference_of(line.exact_late, line.exact_early))) ++moving;
  }
  std::string verdict;
  if (known == 0) {
    verdict = "whether it moves without a step cannot be told";
  } else if (moving == known) {
    verdict = "that it moves with the length of the run is physics";
  } else if (moving == 0) {
    verdict = "that it moves without a step does not show beyond three standard errors";
  } else {
    verdict = fmt::format("without a step it moves, beyond three standard errors, from {} of {} starts", moving, known);
  }
  return fmt::format("From a tenth of the run to its end the crossing moves in φ by {}: {}.", fmt::join(parts, ", "),
                     verdict);
}

PageTable contact_table(std::vector<ContactsBesideExact> const& contacts) {
  PageTable table{
      .header = {"start", "φ", "time step", "displacement: approaching", "always", "exact",
                 "collisions per disk and time: approaching", "always", "exact", "standstill: approaching", "always"},
      .caption =
          "The comparison of the choices above, at the same physical time. Collisions over the last "
          "fifth of the runs. Standstill: more than 98 % of all moves halted there. Exact disks "
          "take no turns and are never halted, so there is no standstill to count."};
  auto const count = [](ContactResult const& result) { return fmt::format("{} of {}", result.arrested, result.runs); };
  auto const rate = [](ContactResult const& result) { return fmt::format("{:.0f}", result.collision_rate); };
  for (ContactsBesideExact const& one : contacts) {
    table.rows.push_back({name_of(one.start), fmt::format("{}", one.packing_fraction), fmt::format("{}", one.time_step),
                          to_text(one.approaching.displacement), to_text(one.always.displacement),
                          one.exact ? to_text(one.exact->displacement) : "–", rate(one.approaching), rate(one.always),
                          one.exact ? rate(*one.exact) : "–", count(one.approaching), count(one.always)});
  }
  return table;
}

/// The lowest and the highest of some ratios.
struct Range {
  double least = std::numeric_limits<double>::infinity();
  double most = -std::numeric_limits<double>::infinity();

  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  [[nodiscard]] bool is_empty() const { return least > most; }
  [[nodiscard]] std::string text() const {
    std::string const low = fmt::format("{:.2g}", least);
    std::string const high = fmt::format("{:.2g}", most);
    return low == high ? low : fmt::format("{} to {}", low, high);
  }
};

/// Where one contact rule came to rest, and what the disks did there beside exact ones.
std::string standstill_text(std::vector<ContactsBesideExact> const& contacts, ContactResult ContactsBesideExact::*which,
                            char const* name) {
  std::size_t arrested = 0;
  std::size_t runs = 0;
  std::vector<std::string> places;
  Range displacements;
  Range collisions;
  for (ContactsBesideExact const& one : contacts) {
    ContactResult const& result = one.*which;
    arrested += result.arrested;
    runs += result.runs;
    if (result.arrested == 0) continue;
    places.push_back(fmt::format("φ = {} {} with steps of {} ({} of {})", one.packing_fraction, name_of(one.start),
                                 one.time_step, result.arrested, result.runs));
    if (!one.exact) continue;
    displacements.add(result.displacement.value / one.exact->displacement.value);
    collisions.add(result.collision_rate / one.exact->collision_rate);
  }
  if (arrested == 0) return fmt::format("With contact = \"{}\" none of {} runs came to rest.", name, runs);
  std::string text = fmt::format("With contact = \"{}\" {} of {} runs came to rest: {}.", name, arrested, runs,
                                 fmt::join(places, ", "));
  if (!collisions.is_empty()) {
    text += fmt::format(
        " There the disks collide {} times as often as exact ones at the same density and have moved "
        "{} times as far.",
        collisions.text(), displacements.text());
  }
  return text;
}

std::string step_text(std::vector<ContactsBesideExact> const& contacts) {
  std::size_t arrested = 0;
  for (ContactsBesideExact const& one : contacts) arrested += one.always.arrested + one.approaching.arrested;
  return fmt::format(
      "{} {} An exact run cannot come to rest, by construction: no disk is ever halted, each flies on at its speed, "
      "and the "
      "energy does not change. {}",
      standstill_text(contacts, &ContactsBesideExact::approaching, "approaching"),
      standstill_text(contacts, &ContactsBesideExact::always, "always"),
      arrested > 0 ? "So every standstill is the rule's." : "Under the rule none of these runs did either.");
}

}  // namespace

Chapter chapter_from(StepEvidence const& evidence) {
  Chapter chapter{.title = "Physics, or the time step?"};
  chapter.introduction.push_back(
      "The same disks from the same starts for the same physical time, moved by the paper's rule with its steps of 0.1 "
      "diameters per v_max, and from collision to collision without a step.");
  chapter.tables.push_back(point_table(evidence));
  chapter.conclusions.push_back("**The points.** " + point_text(evidence.points));
  if (!evidence.lines.empty()) {
    chapter.conclusions.push_back(fmt::format("**The 10 % line.** {} {} {}", line_text(evidence.lines),
                                              crossing_verdict(evidence.lines), movement_verdict(evidence.lines)));
  }
  if (!evidence.contacts.empty()) {
    chapter.tables.push_back(contact_table(evidence.contacts));
    chapter.conclusions.push_back("**Standstills.** " + step_text(evidence.contacts));
  }
  return chapter;
}

Chapter physics_or_step(Study& study) {
  auto const exact = exact_engine(study.extent());
  if (!exact) return {.title = "Physics, or the time step?"};
  return chapter_from(evidence_of(study, *exact));
}

}  // namespace gridlock
