#include "gridlock/protocol/settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

#include "engine/event_chain.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/packing/pressure_ramp.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

namespace {

constexpr std::array<std::string_view, 2> box_shape_names{"fixed", "free"};
constexpr std::array<std::string_view, 2> deformation_names{"simple_shear", "pure_shear"};

/// Lists the names of the optional settings that are given.
class GivenSettings final : public SettingVisitor {
 public:
  std::vector<std::string_view> names;

  void enter(std::string_view /*name*/, std::string_view /*documentation*/) override {}
  void leave() override {}
  void visit(SettingInfo const& /*info*/, double& /*value*/) override {}
  void visit(SettingInfo const& info, std::optional<double>& value) override { note(info, value.has_value()); }
  void visit(SettingInfo const& /*info*/, std::uint64_t& /*value*/) override {}
  void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) override { note(info, value.has_value()); }
  void visit(SettingInfo const& /*info*/, bool& /*value*/) override {}
  void visit(SettingInfo const& /*info*/, std::string& /*value*/) override {}
  void visit(SettingInfo const& /*info*/, std::vector<double>& /*value*/) override {}
  void visit_choice(SettingInfo const& info, std::span<std::string_view const> /*choices*/,
                    std::size_t& value) override {
    note(info, info.key != "stage" && value != 0);  // the first choice is the default
  }
  void visit_tables(SettingInfo const& /*info*/, std::size_t /*size*/,
                    std::function<void(std::size_t)> const& /*resize*/,
                    std::function<void(std::size_t, SettingVisitor&)> const& /*describe_one*/) override {}

 private:
  void note(SettingInfo const& info, bool is_given) {
    if (is_given) names.push_back(info.key);
  }
};

bool contains(std::vector<std::string_view> const& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

void check_settings(StageCheck const& check, StageRecord const& record) {
  StageSettings stage = check.stage;
  GivenSettings given;
  describe(stage, given);
  for (std::string_view const setting : given.names) {
    if (contains(record.settings, setting)) continue;
    check.report(setting, fmt::format("a stage \"{}\" has no setting {}", record.name, setting),
                 record.settings.empty() ? std::string("it has none")
                                         : fmt::format("it has {}", fmt::join(record.settings, ", ")));
  }
  bool const has_end =
      std::ranges::any_of(record.ends, [&](std::string_view setting) { return contains(given.names, setting); });
  if (!record.ends.empty() && !has_end) {
    check.report("", fmt::format("a stage \"{}\" does not say when it ends", record.name),
                 fmt::format("give {}", fmt::join(record.ends, " or ")));
  }
  if (record.check != nullptr) record.check(check);
}

/// Visits a setting whose value is a name in the registry of stages; an unknown name is left for the checks that
/// follow.
void visit_stage(SettingVisitor& visitor, std::string& kind) {
  std::vector<std::string_view> kinds;
  std::string documentation =
      "What happens: hard disks grow, run, or swap their radii; soft disks are quenched, compressed or decompressed";
  for (StageRecord const& record : stage_records()) {
    kinds.push_back(record.name);
    if (!record.documentation.empty()) documentation += fmt::format("; {} {}", record.name, record.documentation);
  }
  documentation += ".";
  auto place = static_cast<std::size_t>(std::ranges::find(kinds, kind) - kinds.begin());
  visitor.visit_choice({.key = "stage", .documentation = documentation, .default_note = "none: has to be given"}, kinds,
                       place);
  if (place < kinds.size()) kind = kinds[place];
}

}  // namespace

void describe(StageSettings& settings, SettingVisitor& visitor) {
  visit_stage(visitor, settings.kind);
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
  visit_enum(
      visitor,
      {.key = "box_shape",
       .documentation = "quench, compress, decompress: free: pure and simple shear of a periodic box at constant "
                        "area belong to the minimum, which then has no shear stress and is stable against shear."},
      box_shape_names, settings.box_shape);
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
                 .documentation = "swap, monte_carlo: trial moves for each disk; event_chain: contacts for each disk, "
                                  "about.",
                 .min = 1,
                 .max = static_cast<double>(max_sweeps),
                 .default_note = "none"},
                settings.sweeps);
  visitor.visit(
      {.key = "pressure",
       .documentation = "swap, monte_carlo: βP D̄² for the mean diameter D̄; all radii then change together by trial "
                        "moves, so that the packing fraction becomes that of the pressure.",
       .min = 0.0,
       .min_is_allowed = false,
       .default_note = "none: constant packing fraction"},
      settings.pressure);
  visitor.visit({.key = "swap_fraction",
                 .documentation = "swap: share of the trial moves that exchange two radii.",
                 .min = 0.0,
                 .max = 1.0,
                 .max_is_allowed = false,
                 .default_note = "0.2"},
                settings.swap_fraction);
  describe_chains(settings.chains, settings.chain_length, visitor);
  visit_enum(visitor,
             {.key = "deformation",
              .documentation = "shear: simple_shear tilts the box, x ← x + γ y; pure_shear makes it longer along x, "
                               "x ← x e^(γ/2), and shorter along y."},
             deformation_names, settings.deformation);
  visitor.visit({.key = "strain_step",
                 .documentation = "shear: strain between two minima.",
                 .min = 0.0,
                 .max = 0.1,
                 .min_is_allowed = false,
                 .default_note = "0.001"},
                settings.strain_step);
  visitor.visit({.key = "until_strain",
                 .documentation = "shear: the strain at which the stage ends, below 0 for the other direction; the "
                                  "amplitude of cycles.",
                 .min = -1e3,
                 .max = 1e3,
                 .default_note = "none: has to be given"},
                settings.until_strain);
  visitor.visit({.key = "until_stress",
                 .unit = "ε/D²",
                 .documentation = "shear: the stage ends at the first minimum after a step whose shear stress is as "
                                  "large, before the strain is "
                                  "reached.",
                 .min = 0.0,
                 .min_is_allowed = false,
                 .default_note = "no end by stress"},
                settings.until_stress);
  visitor.visit({.key = "cycles",
                 .documentation = "shear: cycles of strain, each from 0 to until_strain, to −until_strain and back.",
                 .min = 1,
                 .max = 1e6,
                 .default_note = "none: one way"},
                settings.cycles);
  visitor.visit({.key = "strain_accuracy",
                 .documentation = "shear: steps are halved until a drop of the stress lies within this strain.",
                 .min = 1e-12,
                 .max = 0.1,
                 .default_note = "0.001 strain_step"},
                settings.strain_accuracy);
  visitor.visit({.key = "min_drop",
                 .unit = "ε/D²",
                 .documentation = "shear: a smaller drop of the stress is no event.",
                 .min = 0.0,
                 .min_is_allowed = false,
                 .default_note = "0.2 strain_step"},
                settings.min_drop);
}

void describe(SoftSettings& settings, SettingVisitor& visitor) {
  visit_enum(
      visitor,
      {.key = "potential",
       .documentation = "Energy of two disks that overlap by δ = 1 − r/σ: harmonic ½ ε δ² or Hertzian ⅖ ε δ^(5/2)."},
      std::array<std::string_view, 2>{to_text(Potential::harmonic), to_text(Potential::hertzian)}, settings.potential);
  visitor.visit(
      {.key = "residual",
       .documentation = "A minimum is found where the largest net force is this share of the mean contact force.",
       .min = 0.0,
       .max = 1.0,
       .min_is_allowed = false,
       .max_is_allowed = false},
      settings.residual);
}

bool tilts(StageSettings const& stage) {
  bool const deforms = contains(stage_record(stage.kind).settings, "deformation");
  return stage.box_shape == BoxShape::free || (deforms && stage.deformation == Deformation::simple_shear);
}

void require_valid(std::vector<StageSettings> const& stages, std::optional<double> packing_fraction) {
  std::vector<Problem> problems;
  StageRecord const* before = nullptr;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    StageRecord const& record = stage_record(stages[k].kind);
    StageCheck const check{stages[k], packing_fraction, fmt::format("protocol[{}]", k), problems};
    check_settings(check, record);
    if (record.packing_fraction_after != nullptr)
      packing_fraction = record.packing_fraction_after(stages[k], packing_fraction);
    if (before != nullptr && before->leaves_overlaps && record.needs_no_overlaps) {
      check.report("",
                   fmt::format("a stage \"{}\" of hard disks cannot begin where \"{}\" leaves overlaps", record.name,
                               before->name),
                   "put a stage \"separate\" between the two");
    }
    auto const tilting = std::find_if(stages.begin(), stages.begin() + static_cast<std::ptrdiff_t>(k), tilts);
    if (record.needs_rectangle && tilting != stages.begin() + static_cast<std::ptrdiff_t>(k)) {
      check.report("",
                   fmt::format("a stage \"{}\" knows rectangles only, and the stage \"{}\" before it leaves a tilt",
                               record.name, tilting->kind),
                   "put it in front of that stage");
    }
    before = &record;
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

}  // namespace gridlock
