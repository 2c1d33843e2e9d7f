#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "gridlock/packing/minimizer.hpp"
#include "gridlock/packing/pressure_ramp.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

MinimizerSettings minimizer_settings(ProtocolSettings const& protocol, StageSettings const& stage) {
  return {.potential = protocol.soft.potential,
          .box_shape = stage.box_shape,
          .residual = protocol.soft.residual,
          .threads = protocol.threads};
}

void add_end(ContactNetwork const& network, SoftSettings const& soft, StageResult& result) {
  result.pressure = network.pressure;
  std::optional<VibrationMode> const mode = find_softest_mode(network);
  if (mode) result.softest_mode = mode->eigenvalue;
  result.is_jammed = network.is_jammed(soft.residual, result.softest_mode);
  double overlaps = 0.0;
  for (Contact const& contact : network.contacts) overlaps += contact.overlap();
  if (!network.contacts.empty()) result.mean_overlap = overlaps / static_cast<double>(network.contacts.size());
}

namespace {

/// Reports a pressure that soft disks cannot reach.
void check_soft_pressure(StageCheck const& check) {
  if (check.stage.until_pressure && *check.stage.until_pressure >= 1.0)
    check.report_pressure("the pressure of soft disks is in ε/D²: use a number below 1, such as 1e-6");
}

void scale_to(Packing& packing, double target) {
  double const factor = std::sqrt(target / packing_fraction(packing));
  for (double& radius : packing.radius) radius *= factor;
}

Packing quenched_packing(State const& state, std::optional<double> target) {
  Packing packing = packing_of(state);
  if (target) scale_to(packing, *target);
  return packing;
}

class QuenchStage final : public Stage {
 public:
  QuenchStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : soft_(protocol.soft),
        minimizer_(minimizer_settings(protocol, protocol.stages[number]),
                   quenched_packing(state, protocol.stages[number].packing_fraction)) {}

  bool advance(State& state, ShouldContinue const& should_continue) override {
    if (!minimizer_.advance(should_continue)) return false;
    write_packing(minimizer_.packing(), state);
    return true;
  }
  void serialize(Archive& archive, State const& /*state*/) override { minimizer_.serialize(archive); }
  [[nodiscard]] std::uint64_t work() const override { return minimizer_.iterations(); }
  [[nodiscard]] StageResult result(State const& state) const override {
    ContactNetwork const network = find_contact_network(minimizer_.packing(), soft_.potential);
    PressureLevel level = level_of(minimizer_.packing(), network);
    level.iterations = work();
    StageResult result{.packing_fraction = packing_fraction_of(state),
                       .is_converged = minimizer_.status() != MinimumStatus::unconverged,
                       .levels = {level}};
    if (!*result.is_converged) result.packing_fraction_without_minimum = result.packing_fraction;
    add_end(network, soft_, result);
    return result;
  }

 private:
  SoftSettings soft_;
  Minimizer minimizer_;
};

constexpr std::string_view compress_name = "compress";
constexpr std::string_view decompress_name = "decompress";

class RampStage final : public Stage {
 public:
  RampStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : settings_(protocol.stages[number]),
        soft_(protocol.soft),
        ramp_(ramp_settings(settings_, protocol), packing_of(state)) {
    require_direction(packing_fraction_of(state));
  }

  bool advance(State& state, ShouldContinue const& should_continue) override {
    auto const may_continue = [&] { return !leads_away() && (!should_continue || should_continue()); };
    if (!leads_away() && !ramp_.advance(may_continue) && !leads_away()) return false;
    write_packing(ramp_.packing(), state);
    return true;
  }
  void serialize(Archive& archive, State const& /*state*/) override { ramp_.serialize(archive); }
  [[nodiscard]] std::uint64_t work() const override { return ramp_.minimizer().iterations(); }
  [[nodiscard]] StageResult result(State const& state) const override {
    StageResult result{.packing_fraction = packing_fraction_of(state),
                       .is_converged = ramp_.status() == RampStatus::reached,
                       .packing_fraction_without_minimum = ramp_.packing_fraction_without_minimum(),
                       .levels = ramp_.levels()};
    if (result.levels.empty()) return result;
    add_end(find_contact_network(ramp_.packing(), soft_.potential), soft_, result);
    double const jamming = result.levels.back().jamming_packing_fraction;
    if (std::isfinite(jamming)) result.jamming_packing_fraction = jamming;
    result.error_of_jamming_packing_fraction = ramp_.error_of_jamming_packing_fraction();
    return result;
  }

 private:
  bool compresses() const { return settings_.kind == compress_name; }

  void require_direction(double now) const {
    if (!settings_.until_packing_fraction) return;
    double const end = *settings_.until_packing_fraction;
    constexpr double rounding = 1e-9;
    if (compresses() ? end >= now * (1.0 - rounding) : end <= now * (1.0 + rounding)) return;
    throw Error({.what = fmt::format("the packing fraction is {:.6g}, and the stage ends at {:.6g}", now, end),
                 .hint = fmt::format("use a stage \"{}\"", compresses() ? "decompress" : "compress"),
                 .key = "protocol.until_packing_fraction"});
  }

  /// Returns whether the first minimum is already beyond the goal: a decompression cannot compress.
  bool leads_away() const {
    if (!settings_.until_pressure || ramp_.levels().empty()) return false;
    constexpr double tolerance = PressureRamp::max_share_of_goal;
    double const first = ramp_.levels().front().pressure;
    return compresses() ? first > tolerance * *settings_.until_pressure : tolerance * first < *settings_.until_pressure;
  }

  static PressureRampSettings ramp_settings(StageSettings const& settings, ProtocolSettings const& protocol) {
    PressureRampSettings ramp{.minimizer = minimizer_settings(protocol, settings),
                              .packing_fraction = settings.until_packing_fraction};
    ramp.pressure = settings.until_pressure.value_or(ramp.pressure);
    ramp.levels_per_decade = settings.levels_per_decade.value_or(ramp.levels_per_decade);
    ramp.step = settings.step.value_or(ramp.step);
    return ramp;
  }

  StageSettings settings_;
  SoftSettings soft_;
  PressureRamp ramp_;
};

/// Reports a ramp with more levels than memory can hold.
void check_levels(StageCheck const& check) {
  StageSettings const& stage = check.stage;
  if (!check.packing_fraction || !stage.until_packing_fraction) return;
  try {
    require_countable_levels(*check.packing_fraction, *stage.until_packing_fraction,
                             stage.step.value_or(PressureRampSettings{}.step), fmt::format("{}.step", check.place));
  } catch (Error const& error) {
    check.problems.push_back(error.problems().front());
  }
}

void check_ramp(StageCheck const& check) {
  StageSettings const& stage = check.stage;
  bool const compresses = stage.kind == compress_name;
  check_soft_pressure(check);
  if (stage.until_pressure && stage.until_packing_fraction) {
    check.report("until_packing_fraction",
                 fmt::format("a stage \"{}\" cannot end at a pressure and at a packing fraction", stage.kind),
                 "give one of the two");
  }
  if (!compresses && stage.until_packing_fraction && stage.levels_per_decade) {
    check.report("levels_per_decade", "levels of pressure mean nothing where a packing fraction is the end",
                 "leave levels_per_decade out; step is the distance of the levels");
  }
  check.check_direction(compresses, compresses ? decompress_name : compress_name);
  check_levels(check);
}

/// Throws Error for a first stage `decompress` of disks without contacts. Later stages accept any disks.
void require_pressing(State const& start) {
  if (!find_contacts(packing_of(start)).empty()) return;
  throw Error({.what = fmt::format("stage 1 of the protocol, \"decompress\", has nothing to decompress: at packing "
                                   "fraction {:.6g} no two disks press on each other",
                                   packing_fraction_of(start)),
               .hint = "begin with a stage \"quench\" or \"compress\" that ends above jamming, such as at 0.9",
               .key = "protocol[0].stage"});
}

/// Returns the record of a ramp with this name.
StageRecord ramp_stage(std::string_view name, std::vector<std::string_view> settings) {
  return {.name = name,
          .settings = std::move(settings),
          .ends = {"until_packing_fraction", "until_pressure"},
          .leaves_overlaps = true,
          .has_soft_disks = true,
          .check = check_ramp,
          .packing_fraction_after = packing_fraction_at_end,
          .make = make_stage<RampStage>};
}

/// Returns the factor of all radii with which no two disks, and no disk and wall, overlap.
double separating_factor(Packing const& packing) {
  double factor = 1.0;
  for (Contact const& contact : find_contacts(packing)) {
    factor = std::min(factor, contact.distance / contact.contact_distance);
  }
  // Rounding must not leave an overlap.
  return factor < 1.0 ? factor * (1.0 - 4.0 * std::numeric_limits<double>::epsilon()) : 1.0;
}

class SeparateStage final : public Stage {
 public:
  SeparateStage(ProtocolSettings const& /*protocol*/, std::size_t /*number*/, State const& /*state*/) {}

  bool advance(State& state, ShouldContinue const& /*should_continue*/) override {
    Packing packing = packing_of(state);
    double const factor = separating_factor(packing);
    if (!(factor > 0.0))
      throw RunFailure("two disks are at one place: no radii keep them apart\n  hint: quench them first");
    for (double& radius : packing.radius) radius *= factor;
    write_packing(packing, state);
    return true;
  }
  void serialize(Archive& /*archive*/, State const& /*state*/) override {}
  [[nodiscard]] std::uint64_t work() const override { return 0; }
  [[nodiscard]] StageResult result(State const& state) const override {
    return {.packing_fraction = packing_fraction_of(state)};
  }
};

}  // namespace

StageRecord quench_stage() {
  return {.name = "quench",
          .settings = {"packing_fraction", "box_shape"},
          .leaves_overlaps = true,
          .has_soft_disks = true,
          .may_end_without_pressure = true,
          .check = check_soft_pressure,
          .packing_fraction_after =
              [](StageSettings const& stage, std::optional<double> before) {
                return stage.packing_fraction ? stage.packing_fraction : before;
              },
          .make = make_stage<QuenchStage>};
}

StageRecord compress_stage() {
  return ramp_stage(compress_name, {"box_shape", "until_packing_fraction", "until_pressure", "step"});
}

StageRecord decompress_stage() {
  StageRecord record = ramp_stage(
      decompress_name, {"box_shape", "until_packing_fraction", "until_pressure", "levels_per_decade", "step"});
  record.require_start = require_pressing;
  return record;
}

StageRecord separate_stage() {
  return {.name = "separate",
          .documentation = "shrinks them until none overlap",
          .has_soft_disks = true,
          .packing_fraction_after = [](StageSettings const&, std::optional<double>) { return std::optional<double>(); },
          .make = make_stage<SeparateStage>};
}

void write_packing(Packing const& packing, State& state) {
  Disks& disks = state.agents;
  std::vector<std::uint32_t> const rows = rows_in_order(disks.ids());
  state.box = packing.box;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::size_t const row = rows[i];
    disks.column<ImageX>()[row] += packing.widths_shifted_back * disks.column<ImageY>()[row];
    Vector p{packing.x[i], packing.y[i]};
    int crossed_x = 0;
    int crossed_y = 0;
    // Coordinates are wrapped by one side at a time; a minimization moves disks by few sides at most.
    for (int before_x = -1, before_y = -1; before_x != crossed_x || before_y != crossed_y;) {
      before_x = crossed_x;
      before_y = crossed_y;
      p = state.box.wrap(p, crossed_x, crossed_y);
    }
    disks.column<X>()[row] = p.x;
    disks.column<Y>()[row] = p.y;
    disks.column<ImageX>()[row] += crossed_x;
    disks.column<ImageY>()[row] += crossed_y;
    disks.column<Radius>()[row] = packing.radius[i];
  }
}

}  // namespace gridlock
