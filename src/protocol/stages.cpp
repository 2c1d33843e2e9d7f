#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "gridlock/packing/contact_network.hpp"
#include "gridlock/packing/elasticity.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

namespace {

MinimizerSettings minimizer_settings(ProtocolSettings const& protocol) {
  return {.potential = protocol.soft.potential, .residual = protocol.soft.residual, .threads = protocol.threads};
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

/// The results from the contacts at the end of a stage.
void add_end(ContactNetwork const& network, SoftSettings const& soft, StageResult& result) {
  result.pressure = network.pressure;
  std::optional<VibrationMode> const mode = find_softest_mode(network);
  if (mode) result.softest_mode = mode->eigenvalue;
  result.is_jammed = network.is_jammed(soft.residual, result.softest_mode);
  double overlaps = 0.0;
  for (Contact const& contact : network.contacts) overlaps += contact.overlap();
  if (!network.contacts.empty()) result.mean_overlap = overlaps / static_cast<double>(network.contacts.size());
}

class QuenchStage final : public Stage {
 public:
  QuenchStage(StageSettings const& settings, ProtocolSettings const& protocol, State const& state)
      : soft_(protocol.soft),
        minimizer_(minimizer_settings(protocol), quenched_packing(state, settings.packing_fraction)) {}

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

class RampStage final : public Stage {
 public:
  RampStage(StageSettings const& settings, ProtocolSettings const& protocol, State const& state)
      : settings_(settings), soft_(protocol.soft), ramp_(ramp_settings(settings, protocol), packing_of(state)) {
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
  bool compresses() const { return settings_.kind == StageKind::compress; }

  void require_direction(double now) const {
    if (!settings_.until_packing_fraction) return;
    double const end = *settings_.until_packing_fraction;
    constexpr double rounding = 1e-9;
    if (compresses() ? end >= now * (1.0 - rounding) : end <= now * (1.0 + rounding)) return;
    throw Error({.what = fmt::format("the packing fraction is {:.6g}, and the stage ends at {:.6g}", now, end),
                 .hint = fmt::format("use a stage \"{}\"", compresses() ? "decompress" : "compress"),
                 .key = "protocol.until_packing_fraction"});
  }

  /// Whether the first minimum lies beyond the pressure to reach: a decompression does not compress.
  bool leads_away() const {
    if (!settings_.until_pressure || ramp_.levels().empty()) return false;
    constexpr double tolerance = PressureRamp::max_share_of_goal;
    double const first = ramp_.levels().front().pressure;
    return compresses() ? first > tolerance * *settings_.until_pressure : tolerance * first < *settings_.until_pressure;
  }

  static PressureRampSettings ramp_settings(StageSettings const& settings, ProtocolSettings const& protocol) {
    PressureRampSettings ramp{.minimizer = minimizer_settings(protocol),
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

/// Hard disks that grow; the reduced pressure is that of the last rescaling.
class GrowStage final : public Stage {
 public:
  GrowStage(StageSettings const& settings, State const& state) : growth_(growth_settings(settings), state) {}

  bool advance(State& state, ShouldContinue const& should_continue) override {
    return growth_.advance(state, counters_, should_continue);
  }
  void serialize(Archive& archive, State const& state) override {
    serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
    serialize_inside(archive, "growth", [&] { growth_.serialize(archive, state); });
  }
  [[nodiscard]] std::uint64_t work() const override { return counters_.moves; }
  [[nodiscard]] StageResult result(State const& state) const override {
    return {.packing_fraction = packing_fraction_of(state),
            .pressure = growth_.reduced_pressure(),
            .pair_collisions = counters_.pair_collisions};
  }

 private:
  static GrowthSettings growth_settings(StageSettings const& settings) {
    GrowthSettings growth{.packing_fraction = settings.until_packing_fraction, .pressure = settings.until_pressure};
    growth.rate = settings.rate.value_or(growth.rate);
    return growth;
  }

  Growth growth_;
  Counters counters_;
};

/// Swap Monte Carlo of hard disks.
class SwapStage final : public Stage {
 public:
  SwapStage(StageSettings const& settings, std::uint64_t number, State const& state)
      : swap_(swap_settings(settings, number), state) {}

  bool advance(State& state, ShouldContinue const& should_continue) override {
    return swap_.advance(state, should_continue);
  }
  void serialize(Archive& archive, State const& state) override { swap_.serialize(archive, state); }
  [[nodiscard]] std::uint64_t work() const override { return swap_.sweeps_done(); }
  [[nodiscard]] StageResult result(State const& state) const override {
    SwapReport const report = swap_.report();
    SwapResult swap{.displacement_acceptance = report.displacement_acceptance,
                    .swap_acceptance = report.swap_acceptance,
                    .overlap_relaxation_time = report.overlap_relaxation_time,
                    .bond_relaxation_time = report.bond_relaxation_time,
                    .relaxation_times = report.relaxation_times,
                    .is_equilibrated = report.is_equilibrated};
    for (SwapCorrelation const& correlation : swap_.correlations()) {
      swap.lags.push_back(static_cast<double>(correlation.lag));
      swap.self_overlap.push_back(correlation.self_overlap);
      swap.bond_orientation.push_back(correlation.bond_orientation);
    }
    return {.packing_fraction = packing_fraction_of(state), .swap = std::move(swap)};
  }

 private:
  static SwapSettings swap_settings(StageSettings const& settings, std::uint64_t number) {
    SwapSettings swap{.stage = number};
    swap.sweeps = settings.sweeps.value_or(swap.sweeps);
    swap.swap_fraction = settings.swap_fraction.value_or(swap.swap_fraction);
    return swap;
  }

  SwapMonteCarlo swap_;
};

/// The factor for all radii with which no two disks, and no disk and wall, overlap.
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

/// Hard disks by the engine "exact"; the reduced pressure is that of the whole stage.
class RunStage final : public Stage {
 public:
  RunStage(StageSettings const& settings, ProtocolSettings const& protocol, State const& state)
      : engine_(make_engine({.kind = "exact", .time_step = protocol.time_step}, state)), start_time_(state.clock.time) {
    if (!settings.until_time) require_moving(state);
    if (settings.until_time) end_at_time(*settings.until_time);
    if (settings.collisions_per_disk) end_at_collisions(*settings.collisions_per_disk, state.agents.size());
  }

  bool advance(State& state, ShouldContinue const& should_continue) override {
    stop_condition_.should_continue = should_continue;
    engine_->advance(state, counters_, stop_condition_);
    stop_condition_.should_continue = {};
    return stop_condition_.is_reached(state.clock, counters_.pair_collisions);
  }
  void serialize(Archive& archive, State const& state) override {
    archive.visit("start_time", start_time_);
    archive.visit("until_time", stop_condition_.time);
    serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
    serialize_inside(archive, "engine", [&] { engine_->serialize(archive, state); });
  }
  [[nodiscard]] std::uint64_t work() const override { return counters_.moves; }
  [[nodiscard]] StageResult result(State const& state) const override {
    StageResult result{.packing_fraction = packing_fraction_of(state), .pair_collisions = counters_.pair_collisions};
    double const time = state.clock.time - start_time_;
    double const energy = kinetic_energy(state.agents);
    // βP/ρ = 1 + Σ r·Δp / (2 t E_kin): two dimensions, N kT = E_kin.
    if (time > 0.0 && energy > 0.0) result.pressure = 1.0 + counters_.pair_virial / (2.0 * time * energy);
    return result;
  }

 private:
  /// Disks at rest, or one alone, never collide.
  static void require_moving(State const& state) {
    if (state.agents.size() > 1 && kinetic_energy(state.agents) > 0.0) return;
    throw Error({.what = fmt::format("{} disks with kinetic energy {} never collide", state.agents.size(),
                                     kinetic_energy(state.agents)),
                 .hint = "use two or more disks, with velocities",
                 .key = "velocities"});
  }

  void end_at_time(double duration) {
    // The clock has to count steps up to there.
    double const end = start_time_ + duration;
    double const spacing = std::nextafter(end, std::numeric_limits<double>::infinity()) - end;
    if (!(0.5 * spacing <= 1e-3 * engine_->time_step())) {
      throw Error({.what = fmt::format("no clock counts up to time {:.6g}", end),
                   .hint = "use a shorter time, or collisions_per_disk",
                   .key = "stage.until_time"});
    }
    stop_condition_.time = end;
  }

  void end_at_collisions(double collisions_per_disk, std::size_t disks) {
    // Counts of collisions end before 2⁶⁴.
    constexpr double most = 9e18;
    double const pairs = std::ceil(collisions_per_disk * static_cast<double>(disks) / 2.0);
    if (!(pairs < most)) {
      throw Error({.what = fmt::format("no stage reaches {:.3g} collisions per disk", collisions_per_disk),
                   .hint = "use a smaller number",
                   .key = "stage.collisions_per_disk"});
    }
    stop_condition_.pair_collisions = static_cast<std::uint64_t>(pairs);
  }

  std::unique_ptr<Engine> engine_;
  double start_time_;
  StopCondition stop_condition_;
  Counters counters_;
};

}  // namespace

std::unique_ptr<Stage> make_stage(ProtocolSettings const& protocol, std::size_t number, State const& state) {
  StageSettings const& settings = protocol.stages[number];
  switch (settings.kind) {
    case StageKind::grow:
      return std::make_unique<GrowStage>(settings, state);
    case StageKind::swap:
      return std::make_unique<SwapStage>(settings, number, state);
    case StageKind::run:
      return std::make_unique<RunStage>(settings, protocol, state);
    case StageKind::quench:
      return std::make_unique<QuenchStage>(settings, protocol, state);
    case StageKind::compress:
    case StageKind::decompress:
      return std::make_unique<RampStage>(settings, protocol, state);
    case StageKind::separate:
      return std::make_unique<SeparateStage>();
  }
  throw Error(Problem{.what = fmt::format("the stage \"{}\" is not known", name_of(settings.kind)), .key = "protocol"});
}

void write_packing(Packing const& packing, State& state) {
  Disks& disks = state.agents;
  std::vector<std::uint32_t> const rows = rows_in_order(disks.ids());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::size_t const row = rows[i];
    Vector p{packing.x[i], packing.y[i]};
    int crossed_x = 0;
    int crossed_y = 0;
    // One side at a time; a minimization moves no disk farther than a few.
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
