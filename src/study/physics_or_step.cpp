#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>

#include "study/figures.hpp"
#include "study/seed_statistics.hpp"

namespace gridlock {

namespace {

/// One point of Figure 7 under the rule and without a time step.
struct Pair {
  StartKind start = StartKind::square;
  double packing_fraction = 0.0;
  Estimate rule;
  Estimate exact;
  std::size_t seeds = 0;

  [[nodiscard]] double error() const { return std::hypot(rule.error.value_or(0.0), exact.error.value_or(0.0)); }
  [[nodiscard]] double deviation() const { return (rule.value - exact.value) / error(); }
  /// Whether chance explains the difference in less than 0.3 % of all cases.
  [[nodiscard]] bool differs() const { return std::abs(deviation()) > three_sigma(2 * (seeds - 1)); }
};

std::optional<PaperEngine> exact_engine(PaperExtent const& extent) {
  for (PaperEngine const& engine : extent.engines) {
    if (engine.kind == "exact" && extent.engines.front().kind != "exact") return engine;
  }
  return std::nullopt;
}

std::vector<Pair> pairs_of(Study const& study, PaperEngine const& exact) {
  std::vector<Pair> pairs;
  for (Ensemble const& ensemble : paper_ensembles(study.extent())) {
    if (ensemble.engine.kind != study.extent().engines.front().kind) continue;
    EnsembleResult const rule(study, ensemble);
    EnsembleResult const without_step(study,
                                      paper_ensemble(study.extent(), exact, ensemble.start, ensemble.packing_fraction));
    if (rule.seeds() < 2 || without_step.seeds() < 2) continue;
    pairs.push_back({.start = ensemble.start,
                     .packing_fraction = ensemble.packing_fraction,
                     .rule = rule.last_displacement(),
                     .exact = without_step.last_displacement(),
                     .seeds = std::min(rule.seeds(), without_step.seeds())});
  }
  return pairs;
}

PageTable table_of(Study const& study, std::vector<Pair> const& pairs) {
  PageTable table{
      .header = {"start", "φ", "the paper's rule", "exact dynamics", "ratio", "difference / standard error"},
      .caption =
          fmt::format("Mean displacement over the side after the physical time of {} steps.", study.extent().steps)};
  for (Pair const& pair : pairs) {
    table.rows.push_back({name_of(pair.start), fmt::format("{}", pair.packing_fraction), to_text(pair.rule),
                          to_text(pair.exact), fmt::format("{:.2f}", pair.rule.value / pair.exact.value),
                          fmt::format("{:+.1f}{}", pair.deviation(), pair.differs() ? " *" : "")});
  }
  return table;
}

std::string agreement_text(std::vector<Pair> const& pairs) {
  std::vector<std::string> differing;
  for (Pair const& pair : pairs) {
    if (!pair.differs()) continue;
    differing.push_back(fmt::format("φ = {} {} ({:.2f} times as far as exact disks)", pair.packing_fraction,
                                    name_of(pair.start), pair.rule.value / pair.exact.value));
  }
  if (differing.empty()) {
    return fmt::format(
        "At none of the {} points do the rule and the exact dynamics differ by more than chance explains "
        "(0.3 %).",
        pairs.size());
  }
  return fmt::format(
      "At {} of {} points the rule and the exact dynamics agree as far as the errors tell. They differ, by "
      "more than chance explains in 0.3 % of all cases, at {}: there the points of the paper's figure show "
      "the finite step.",
      pairs.size() - differing.size(), pairs.size(), fmt::join(differing, ", "));
}

}  // namespace

Chapter physics_or_step(Study& study) {
  Chapter chapter{.title = "Physics, or the time step?"};
  auto const exact = exact_engine(study.extent());
  if (!exact) return chapter;
  std::vector<Pair> const pairs = pairs_of(study, *exact);
  chapter.introduction.push_back(
      "The same disks from the same starts for the same physical time, moved by the paper's rule with its steps of 0.1 "
      "diameters per v_max, and from collision to collision without a step.");
  chapter.tables.push_back(table_of(study, pairs));
  chapter.conclusions.push_back("**What is physics.** " + agreement_text(pairs));
  PaperEngine const& rule = study.extent().engines.front();
  chapter.conclusions.push_back(fmt::format(
      "**The 10 % line.** It is crossed at φ = {} (square start) and {} (triangular) under the rule, at {} and {} by "
      "exact "
      "disks. That it is crossed at all, and that the crossing moves with the length of the run, is physics: slow "
      "diffusion "
      "in a dense fluid and an ordered solid, with or without a step.",
      crossing_text(study, rule, StartKind::square), crossing_text(study, rule, StartKind::triangular),
      crossing_text(study, *exact, StartKind::square), crossing_text(study, *exact, StartKind::triangular)));
  Standstills const always = standstills_under(study, Contact::always);
  Standstills const approaching = standstills_under(study, Contact::approaching);
  if (always.runs > 0 && approaching.runs > 0) {
    chapter.conclusions.push_back(fmt::format(
        "**What is the time step.** Standstills: {} of {} runs with contact = \"approaching\" and {} of {} with "
        "\"always\" "
        "came to rest in the comparison above, none of the exact ones. Halted disks that do not approach keep their "
        "velocities and try the same blocked way again; hard disks never do that.",
        approaching.arrested, approaching.runs, always.arrested, always.runs));
  }
  return chapter;
}

}  // namespace gridlock
