#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/swap/relaxation.hpp"
#include "gridlock/engine/engine.hpp"
#include "gridlock/engine/growth.hpp"
#include "gridlock/engine/swap_monte_carlo.hpp"
#include "protocol/stage.hpp"

namespace gridlock {

namespace {

/// The stage `grow`: hard disks that grow. The reduced pressure is measured since the last rescaling.
class GrowStage final : public Stage {
 public:
  GrowStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : growth_(growth_settings(protocol.stages[number]), state) {}

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

void check_grow(StageCheck const& check) {
  if (check.stage.until_pressure && *check.stage.until_pressure <= 1.0)
    check.report_pressure("the reduced pressure βP/ρ of hard disks is above 1: use for example 1e5");
  check.check_direction(true, "");
}

/// Returns βP/ρ = 1 + Σ r·Δp / (2 t E_kin), because N kT = E_kin in two dimensions; nothing where nothing moves.
std::optional<double> reduced_pressure(Counters const& counters, double time, State const& state) {
  double const energy = kinetic_energy(state.agents);
  if (!(time > 0.0 && energy > 0.0)) return std::nullopt;
  return 1.0 + counters.pair_virial / (2.0 * time * energy);
}

/// The stage `run`: hard disks by the engine `exact`. The reduced pressure is measured over the whole stage.
class RunStage final : public Stage {
 public:
  RunStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : engine_(make_engine({.kind = "exact", .time_step = protocol.time_step}, state)), start_time_(state.clock.time) {
    StageSettings const& settings = protocol.stages[number];
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
    return {.packing_fraction = packing_fraction_of(state),
            .pressure = reduced_pressure(counters_, state.clock.time - start_time_, state),
            .pair_collisions = counters_.pair_collisions};
  }

 private:
  /// Throws Error for disks at rest or a single disk, which never collide.
  static void require_moving(State const& state) {
    if (state.agents.size() > 1 && kinetic_energy(state.agents) > 0.0) return;
    throw Error({.what = fmt::format("{} disks with kinetic energy {} never collide", state.agents.size(),
                                     kinetic_energy(state.agents)),
                 .hint = "use two or more disks, with velocities",
                 .key = "velocities"});
  }

  void end_at_time(double duration) {
    // The clock must have digits enough to count steps up to the end.
    double const end = start_time_ + duration;
    double const spacing = std::nextafter(end, std::numeric_limits<double>::infinity()) - end;
    if (!(0.5 * spacing <= 1e-3 * engine_->time_step())) {
      throw Error({.what = fmt::format("no clock counts up to time {:.6g}", end),
                   .hint = "use a shorter time, or collisions_per_disk",
                   .key = "protocol.until_time"});
    }
    stop_condition_.time = end;
  }

  void end_at_collisions(double collisions_per_disk, std::size_t disks) {
    // Collisions are counted in 64 bits.
    constexpr double most = 9e18;
    double const pairs = std::ceil(collisions_per_disk * static_cast<double>(disks) / 2.0);
    if (!(pairs < most)) {
      throw Error({.what = fmt::format("no stage reaches {:.3g} collisions per disk", collisions_per_disk),
                   .hint = "use a smaller number",
                   .key = "protocol.collisions_per_disk"});
    }
    stop_condition_.pair_collisions = static_cast<std::uint64_t>(pairs);
  }

  std::unique_ptr<Engine> engine_;
  double start_time_;
  StopCondition stop_condition_;
  Counters counters_;
};

/// Returns correlations at lags in sweeps as results.
SwapResult result_of(std::vector<SwapCorrelation> const& correlations) {
  SwapResult result;
  for (SwapCorrelation const& correlation : correlations) {
    result.lags.push_back(static_cast<double>(correlation.lag));
    result.self_overlap.push_back(correlation.self_overlap);
    result.bond_orientation.push_back(correlation.bond_orientation);
  }
  return result;
}

/// The stages `swap` and `monte_carlo`: Monte Carlo of hard disks with and without swaps of radii.
class SwapStage final : public Stage {
 public:
  SwapStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : swap_(swap_settings(protocol.stages[number], number), state) {}

  bool advance(State& state, ShouldContinue const& should_continue) override {
    return swap_.advance(state, should_continue);
  }
  void serialize(Archive& archive, State const& state) override { swap_.serialize(archive, state); }
  [[nodiscard]] std::uint64_t work() const override { return swap_.sweeps_done(); }
  [[nodiscard]] StageResult result(State const& state) const override {
    SwapReport const report = swap_.report();
    SwapResult swap = result_of(swap_.correlations());
    swap.displacement_acceptance = report.displacement_acceptance;
    swap.swap_acceptance = report.swap_acceptance;
    swap.area_acceptance = report.area_acceptance;
    swap.overlap_relaxation_time = report.overlap_relaxation_time;
    swap.bond_relaxation_time = report.bond_relaxation_time;
    swap.relaxation_times = report.relaxation_times;
    swap.density_drift = report.density_drift;
    swap.is_equilibrated = report.is_equilibrated;
    for (SwapDensity const& density : swap_.densities()) {
      swap.density_sweeps.push_back(static_cast<double>(density.sweep));
      swap.packing_fractions.push_back(density.packing_fraction);
      swap.adjusting_stretches += density.is_adjusting ? 1U : 0U;
    }
    return {
        .packing_fraction = packing_fraction_of(state), .pressure = report.reduced_pressure, .swap = std::move(swap)};
  }

 private:
  static SwapSettings swap_settings(StageSettings const& settings, std::uint64_t number) {
    SwapSettings swap{.stage = number};
    swap.sweeps = settings.sweeps.value_or(swap.sweeps);
    swap.swap_fraction = settings.kind == "swap" ? settings.swap_fraction.value_or(swap.swap_fraction) : 0.0;
    swap.pressure = settings.pressure;
    return swap;
  }

  SwapMonteCarlo swap_;
};

/// The stage `event_chain`: hard disks by the engine of this name, whose steps are sweeps here. The clock of the state
/// stays. The reduced pressure is measured over the whole stage.
class EventChainStage final : public Stage {
 public:
  EventChainStage(ProtocolSettings const& protocol, std::size_t number, State const& state)
      : sweeps_(protocol.stages[number].sweeps.value_or(1)), first_step_((number + 1) * (max_sweeps + 1)) {
    StageSettings const& settings = protocol.stages[number];
    engine_ =
        make_engine({.kind = "event_chain", .chains = settings.chains, .chain_length = settings.chain_length}, state);
    relaxation_ = Relaxation(state, sweeps_);
  }

  bool advance(State& state, ShouldContinue const& should_continue) override {
    if (sweep_ == 0) relaxation_.look_at(SwapTrials(state), 0);
    Clock const clock = std::exchange(state.clock, {.step = first_step_ + sweep_});
    bool goes_on = true;
    StopCondition stop_condition;
    stop_condition.should_continue = [&] {
      goes_on = !should_continue || should_continue();
      return goes_on;
    };
    constexpr std::uint64_t longest_search = 1000;  // the search for the next sweep that is due costs no time
    while (goes_on && sweep_ < sweeps_) {
      std::uint64_t next = sweep_ + 1;
      std::uint64_t const last = sweep_ + std::min(longest_search, sweeps_ - sweep_);
      while (next < last && !relaxation_.is_due(next)) ++next;
      stop_condition.step = first_step_ + next;
      engine_->advance(state, counters_, stop_condition);
      sweep_ = state.clock.step - first_step_;
      if (sweep_ == next) relaxation_.look_at(SwapTrials(state), sweep_);
    }
    state.clock = clock;
    return sweep_ == sweeps_;
  }
  void serialize(Archive& archive, State const& state) override {
    archive.visit("sweep", sweep_);
    archive.require(sweep_ <= sweeps_, "more sweeps were done than there are");
    serialize_inside(archive, "counters", [&] { gridlock::serialize(archive, counters_); });
    serialize_inside(archive, "engine", [&] { engine_->serialize(archive, state); });
    serialize_inside(archive, "relaxation", [&] { relaxation_.serialize(archive, state.agents.size(), sweep_); });
  }
  [[nodiscard]] std::uint64_t work() const override { return counters_.moves; }
  [[nodiscard]] StageResult result(State const& state) const override {
    RelaxationTimes const times = relaxation_.times(sweep_);
    SwapResult chains = result_of(relaxation_.correlations());
    chains.overlap_relaxation_time = times.overlap;
    chains.bond_relaxation_time = times.bond;
    chains.relaxation_times = times.in_run;
    chains.is_equilibrated = times.is_enough;
    double const time = static_cast<double>(sweep_) * engine_->time_step();
    return {.packing_fraction = packing_fraction_of(state),
            .pressure = reduced_pressure(counters_, time, state),
            .pair_collisions = counters_.pair_collisions,
            .swap = std::move(chains)};
  }

 private:
  std::uint64_t sweeps_;
  std::uint64_t first_step_;  ///< other steps, and so other random numbers, than those of other stages and of the run
  std::uint64_t sweep_ = 0;
  std::unique_ptr<Engine> engine_;
  Relaxation relaxation_;
  Counters counters_;
};

}  // namespace

StageRecord grow_stage() {
  return {.name = "grow",
          .settings = {"rate", "until_packing_fraction", "until_pressure"},
          .ends = {"until_packing_fraction", "until_pressure"},
          .table_of_errors = "growth",
          .needs_no_overlaps = true,
          .ends_near_jamming = true,
          .check = check_grow,
          .packing_fraction_after = packing_fraction_at_end,
          .make = make_stage<GrowStage>};
}

StageRecord run_stage() {
  return {.name = "run",
          .settings = {"until_time", "collisions_per_disk"},
          .ends = {"until_time", "collisions_per_disk"},
          .needs_no_overlaps = true,
          .make = make_stage<RunStage>};
}

StageRecord swap_stage() {
  return {.name = "swap",
          .settings = {"sweeps", "swap_fraction", "pressure"},
          .ends = {"sweeps"},
          .table_of_errors = "swap",
          .needs_no_overlaps = true,
          .needs_rectangle = true,
          .make = make_stage<SwapStage>};
}

StageRecord event_chain_stage() {
  return {.name = "event_chain",
          .documentation = "moves hard disks in a periodic box by chains, as the engine of this name does",
          .settings = {"sweeps", "chains", "chain_length"},
          .ends = {"sweeps"},
          .table_of_errors = "engine",
          .needs_no_overlaps = true,
          .needs_rectangle = true,
          .needs_images = true,
          .make = make_stage<EventChainStage>};
}

StageRecord monte_carlo_stage() {
  return {.name = "monte_carlo",
          .documentation = "displaces hard disks at random, at constant area or constant pressure",
          .settings = {"sweeps", "pressure"},
          .ends = {"sweeps"},
          .table_of_errors = "swap",
          .needs_no_overlaps = true,
          .needs_rectangle = true,
          .make = make_stage<SwapStage>};
}

}  // namespace gridlock
