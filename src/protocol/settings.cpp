#include "gridlock/protocol/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/packing/pressure_ramp.hpp"

namespace gridlock {

namespace {

constexpr std::array<std::string_view, 7> kind_names{"grow",       "run",      "quench", "compress",
                                                     "decompress", "separate", "swap"};
constexpr std::array<std::string_view, 2> potential_names{"harmonic", "hertzian"};

/// Settings that a kind of stage takes, and those of which it needs one.
struct StageRules {
  std::vector<std::string_view> takes;
  std::vector<std::string_view> needs_one_of;
};

StageRules rules_of(StageKind kind) {
  switch (kind) {
    case StageKind::grow:
      return {{"rate", "until_packing_fraction", "until_pressure"}, {"until_packing_fraction", "until_pressure"}};
    case StageKind::run:
      return {{"until_time", "collisions_per_disk"}, {"until_time", "collisions_per_disk"}};
    case StageKind::quench:
      return {{"packing_fraction"}, {}};
    case StageKind::compress:
      return {{"until_packing_fraction", "until_pressure", "step"}, {"until_packing_fraction", "until_pressure"}};
    case StageKind::decompress:
      return {{"until_packing_fraction", "until_pressure", "levels_per_decade", "step"},
              {"until_packing_fraction", "until_pressure"}};
    case StageKind::separate:
      return {};
    case StageKind::swap:
      return {{"sweeps", "swap_fraction"}, {"sweeps"}};
  }
  return {};
}

std::vector<std::string_view> given_settings(StageSettings const& stage) {
  std::vector<std::string_view> given;
  auto const note = [&](std::string_view name, auto const& value) {
    if (value) given.push_back(name);
  };
  note("rate", stage.rate);
  note("packing_fraction", stage.packing_fraction);
  note("until_packing_fraction", stage.until_packing_fraction);
  note("until_pressure", stage.until_pressure);
  note("until_time", stage.until_time);
  note("collisions_per_disk", stage.collisions_per_disk);
  note("levels_per_decade", stage.levels_per_decade);
  note("step", stage.step);
  note("sweeps", stage.sweeps);
  note("swap_fraction", stage.swap_fraction);
  return given;
}

bool contains(std::vector<std::string_view> const& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

bool is_hard(StageKind kind) { return kind == StageKind::grow || kind == StageKind::run || kind == StageKind::swap; }

/// Hard and soft disks measure pressure differently; one in the units of the other is never reached.
void check_pressure(StageSettings const& stage, std::string const& place, std::vector<Problem>& problems) {
  if (!stage.until_pressure) return;
  double const pressure = *stage.until_pressure;
  bool const is_too_low = stage.kind == StageKind::grow && pressure <= 1.0;
  bool const is_too_high = leaves_overlaps(stage.kind) && pressure >= 1.0;
  if (!is_too_low && !is_too_high) return;
  problems.push_back(
      {.what = fmt::format("a stage \"{}\" cannot end at a pressure of {}", name_of(stage.kind), pressure),
       .hint = is_too_low ? "the reduced pressure βP/ρ of hard disks is above 1: use for example 1e5"
                          : "the pressure of soft disks is in ε/D²: use a number below 1, such as 1e-6",
       .key = fmt::format("{}.until_pressure", place)});
}

/// The packing fraction that a stage leaves; none where the disks decide.
std::optional<double> packing_fraction_after(StageSettings const& stage, std::optional<double> before) {
  switch (stage.kind) {
    case StageKind::run:
    case StageKind::swap:
      return before;
    case StageKind::quench:
      return stage.packing_fraction ? stage.packing_fraction : before;
    case StageKind::separate:
      return std::nullopt;
    case StageKind::grow:
    case StageKind::compress:
    case StageKind::decompress:
      break;
  }
  return stage.until_pressure ? std::nullopt : stage.until_packing_fraction;
}

/// A stage that changes the packing fraction only one way.
void check_direction(StageSettings const& stage, double before, std::string const& place,
                     std::vector<Problem>& problems) {
  bool const leads_up = stage.kind == StageKind::compress || stage.kind == StageKind::grow;
  if (!stage.until_packing_fraction || !(leads_up || stage.kind == StageKind::decompress)) return;
  double const end = *stage.until_packing_fraction;
  constexpr double rounding = 1e-9;
  if (leads_up ? end >= before * (1.0 - rounding) : end <= before * (1.0 + rounding)) return;
  problems.push_back(
      {.what = fmt::format("a stage \"{}\" leads {}, but the packing fraction is {:.6g}, and the stage ends at {:.6g}",
                           name_of(stage.kind), leads_up ? "up" : "down", before, end),
       .hint = stage.kind == StageKind::grow
                   ? fmt::format("use a value above {:.6g}", before)
                   : fmt::format("use a value {} {:.6g}, or a stage \"{}\"", leads_up ? "above" : "below", before,
                                 leads_up ? "decompress" : "compress"),
       .key = fmt::format("{}.until_packing_fraction", place)});
}

/// A ramp whose levels are more than anybody can keep.
void check_levels(StageSettings const& stage, double before, std::string const& place, std::vector<Problem>& problems) {
  bool const is_ramp = stage.kind == StageKind::compress || stage.kind == StageKind::decompress;
  if (!is_ramp || !stage.until_packing_fraction) return;
  try {
    require_countable_levels(before, *stage.until_packing_fraction, stage.step.value_or(PressureRampSettings{}.step),
                             fmt::format("{}.step", place));
  } catch (Error const& error) {
    problems.push_back(error.problems().front());
  }
}

void check_settings(StageSettings const& stage, std::string const& place, std::vector<Problem>& problems) {
  std::string_view const name = name_of(stage.kind);
  StageRules const rules = rules_of(stage.kind);
  std::vector<std::string_view> const given = given_settings(stage);
  for (std::string_view const setting : given) {
    if (contains(rules.takes, setting)) continue;
    problems.push_back({.what = fmt::format("a stage \"{}\" has no setting {}", name, setting),
                        .hint = rules.takes.empty() ? std::string("it has none")
                                                    : fmt::format("it has {}", fmt::join(rules.takes, ", ")),
                        .key = fmt::format("{}.{}", place, setting)});
  }
  bool const has_one =
      std::ranges::any_of(rules.needs_one_of, [&](std::string_view setting) { return contains(given, setting); });
  if (!rules.needs_one_of.empty() && !has_one) {
    problems.push_back({.what = fmt::format("a stage \"{}\" does not say when it ends", name),
                        .hint = fmt::format("give {}", fmt::join(rules.needs_one_of, " or ")),
                        .key = place});
  }
  bool const is_ramp = stage.kind == StageKind::compress || stage.kind == StageKind::decompress;
  check_pressure(stage, place, problems);
  if (is_ramp && stage.until_pressure && stage.until_packing_fraction) {
    problems.push_back({.what = fmt::format("a stage \"{}\" cannot end at a pressure and at a packing fraction", name),
                        .hint = "give one of the two",
                        .key = fmt::format("{}.until_packing_fraction", place)});
  }
  if (stage.kind == StageKind::decompress && stage.until_packing_fraction && stage.levels_per_decade) {
    problems.push_back({.what = "levels of pressure mean nothing where a packing fraction is the end",
                        .hint = "leave levels_per_decade out; step is the distance of the levels",
                        .key = fmt::format("{}.levels_per_decade", place)});
  }
}

}  // namespace

std::string_view name_of(StageKind kind) { return kind_names[static_cast<std::size_t>(kind)]; }

bool leaves_overlaps(StageKind kind) {
  return kind == StageKind::quench || kind == StageKind::compress || kind == StageKind::decompress;
}

void describe(StageSettings& settings, SettingVisitor& visitor) {
  visit_enum(visitor,
             {.key = "stage",
              .documentation =
                  "What happens: hard disks grow, run, or swap their radii; soft disks are quenched, compressed or "
                  "decompressed; separate shrinks them until none overlap.",
              .default_note = "none: has to be given"},
             kind_names, settings.kind);
  visitor.visit(
      {.key = "rate",
       .documentation = "grow: the rate of growth (dD/dt)/√(kT/m), D and m of the smallest disk; at the slowest a "
                        "disk collides 10¹⁰ times before it is jammed.",
       .min = slowest_growth,
       .max = fastest_growth,
       .default_note = "0.001"},
      settings.rate);
  visitor.visit({.key = "packing_fraction",
                 .documentation = "quench: the packing fraction to which all radii are scaled first.",
                 .min = min_packing_fraction,
                 .max = max_packing_fraction_of_stages,
                 .default_note = "as it is"},
                settings.packing_fraction);
  visitor.visit({.key = "until_packing_fraction",
                 .documentation = "grow, compress, decompress: where the stage ends.",
                 .min = min_packing_fraction,
                 .max = max_packing_fraction_of_stages,
                 .default_note = "no end by packing fraction"},
                settings.until_packing_fraction);
  visitor.visit(
      {.key = "until_pressure",
       .documentation = "Where the stage ends: grow at a reduced pressure βP/ρ above 1, compress and decompress at "
                        "P D²/ε below 1.",
       .min = 0.0,
       .min_is_allowed = false,
       .default_note = "no end by pressure"},
      settings.until_pressure);
  visitor.visit({.key = "until_time",
                 .unit = "time",
                 .documentation = "run: the time that passes.",
                 .min = 0.0,
                 .min_is_allowed = false,
                 .default_note = "no end by time"},
                settings.until_time);
  visitor.visit({.key = "collisions_per_disk",
                 .documentation = "run: collisions that every disk has on average.",
                 .min = 0.0,
                 .min_is_allowed = false,
                 .default_note = "no end by collisions"},
                settings.collisions_per_disk);
  visitor.visit({.key = "levels_per_decade",
                 .documentation = "decompress: pressures in a factor of ten at which a minimum is found and kept.",
                 .min = 1,
                 .max = static_cast<double>(PressureRampSettings::max_levels_per_decade),
                 .default_note = "2"},
                settings.levels_per_decade);
  visitor.visit(
      {.key = "step",
       .documentation = "compress, decompress: steps in packing fraction, while nothing presses or where the stage "
                        "ends at one.",
       .min = PressureRampSettings::min_step,
       .max = PressureRampSettings::max_step,
       .default_note = "0.001"},
      settings.step);
  visitor.visit({.key = "sweeps",
                 .documentation = "swap: trial moves for each disk.",
                 .min = 1,
                 .max = static_cast<double>(max_sweeps),
                 .default_note = "none"},
                settings.sweeps);
  visitor.visit({.key = "swap_fraction",
                 .documentation = "swap: share of the trial moves that exchange two radii.",
                 .min = 0.0,
                 .max = 1.0,
                 .max_is_allowed = false,
                 .default_note = "0.2"},
                settings.swap_fraction);
}

void describe(SoftSettings& settings, SettingVisitor& visitor) {
  visit_enum(
      visitor,
      {.key = "potential",
       .documentation = "Energy of two disks that overlap by δ = 1 − r/σ: harmonic ½ ε δ² or Hertzian ⅖ ε δ^(5/2)."},
      potential_names, settings.potential);
  visitor.visit(
      {.key = "residual",
       .documentation = "A minimum is found where the largest net force is this share of the mean contact force.",
       .min = 0.0,
       .max = 1.0,
       .min_is_allowed = false,
       .max_is_allowed = false},
      settings.residual);
}

void require_valid(std::vector<StageSettings> const& stages, std::optional<double> packing_fraction) {
  std::vector<Problem> problems;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    std::string const place = fmt::format("protocol[{}]", k);
    check_settings(stages[k], place, problems);
    if (packing_fraction) check_direction(stages[k], *packing_fraction, place, problems);
    if (packing_fraction) check_levels(stages[k], *packing_fraction, place, problems);
    packing_fraction = packing_fraction_after(stages[k], packing_fraction);
    if (k > 0 && leaves_overlaps(stages[k - 1].kind) && is_hard(stages[k].kind)) {
      problems.push_back({.what = fmt::format("a stage \"{}\" of hard disks cannot begin where \"{}\" leaves overlaps",
                                              name_of(stages[k].kind), name_of(stages[k - 1].kind)),
                          .hint = "put a stage \"separate\" between the two",
                          .key = place});
    }
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace gridlock
