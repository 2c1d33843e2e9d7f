#include "gridlock/engine/swap_monte_carlo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/disks_overview.hpp"
#include "engine/swap/area.hpp"
#include "engine/swap/relaxation.hpp"
#include "engine/swap/trials.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"

namespace gridlock {

namespace {

constexpr double first_step = 0.1;         // largest displacement at the start, in mean diameters
constexpr double min_step = 1e-12;         // least value of the largest displacement, in mean diameters
constexpr double wanted_acceptance = 0.4;  // fraction of displacements accepted
constexpr std::uint64_t displacements_of_an_adjustment = 1000;  // gives the accepted fraction to ±0.015
constexpr std::uint64_t max_stages = std::uint64_t{1} << 24;
constexpr double largest_drift = 0.5;  // of a density in equilibrium; a hundred independent values drift by 0.2

void require(bool holds, std::string what, std::string hint, std::string key) {
  if (!holds) throw Error({.what = std::move(what), .hint = std::move(hint), .key = std::move(key)});
}

void require_bounds(SwapSettings const& settings) {
  require(settings.sweeps >= 1 && settings.sweeps <= max_sweeps,
          fmt::format("{} sweeps of swap Monte Carlo cannot be made", settings.sweeps),
          "use 1 to 10¹²; 100000 are a beginning", "swap.sweeps");
  require(settings.swap_fraction >= 0.0 && settings.swap_fraction < 1.0,
          fmt::format("a share of {} of the trial moves cannot be swaps", settings.swap_fraction),
          "use 0 or more and less than 1; the usual value is 0.2", "swap.swap_fraction");
  require(settings.adjusting >= 0.0 && settings.adjusting < 1.0,
          fmt::format("the step cannot be adjusted in a share of {} of the sweeps", settings.adjusting),
          "use 0 or more and less than 1; the usual value is 0.1", "swap.adjusting");
  if (settings.step) {
    require(std::isfinite(*settings.step) && *settings.step > 0.0,
            fmt::format("a displacement of up to {} diameters is no move", *settings.step),
            "use a positive number, or leave it out", "swap.step");
  }
  if (settings.pressure) {
    require(std::isfinite(*settings.pressure) && *settings.pressure > 0.0,
            fmt::format("hard disks have no area at a pressure βP D̄² of {}", *settings.pressure),
            "use a positive number: 2.61 is φ = 0.5 of equal disks, and they melt at 9.18", "swap.pressure");
  }
  require(settings.stage < max_stages, fmt::format("there is no stage {} of swap Monte Carlo", settings.stage),
          fmt::format("use a number below {}", max_stages), "swap.stage");
}

std::optional<double> share(std::uint64_t part, std::uint64_t all) {
  if (all == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(all);
}

/// Returns the packing fractions of the stretches that averages take.
std::vector<double> packing_fractions_that_count(std::vector<SwapDensity> const& densities) {
  std::vector<double> values;
  for (SwapDensity const& density : densities) {
    if (!density.is_adjusting) values.push_back(density.packing_fraction);
  }
  return values;
}

double mean_of(std::span<double const> values) {
  double sum = 0.0;
  for (double const value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Returns how far the mean of the later half of values is from that of the earlier half, in standard deviations of
/// all.
std::optional<double> drift_of(std::span<double const> values) {
  if (values.size() < 2) return std::nullopt;
  double const mean = mean_of(values);
  double square = 0.0;
  for (double const value : values) square += (value - mean) * (value - mean) / static_cast<double>(values.size());
  if (!(square > 0.0)) return std::nullopt;
  std::size_t const half = values.size() / 2;
  return (mean_of(values.subspan(half)) - mean_of(values.first(half))) / std::sqrt(square);
}

void serialize_counts(Archive& archive, SwapCounts& counts) {
  archive.visit("displacements", counts.displacements);
  archive.visit("accepted_displacements", counts.accepted_displacements);
  archive.visit("swaps", counts.swaps);
  archive.visit("accepted_swaps", counts.accepted_swaps);
  archive.visit("area_changes", counts.area_changes);
  archive.visit("accepted_area_changes", counts.accepted_area_changes);
  archive.require(counts.accepted_displacements <= counts.displacements && counts.accepted_swaps <= counts.swaps &&
                      counts.accepted_area_changes <= counts.area_changes,
                  "more trial moves were accepted than made");
}

}  // namespace

struct SwapMonteCarlo::Progress {
  SwapSettings settings;
  std::uint64_t adjusting_sweeps = 0;
  double diameter = 1.0;      ///< mean diameter
  double longest_step = 1.0;  ///< half the shorter side: a longer displacement would cross the box more than once
  std::uint64_t sweep = 0;
  double step = 1.0;     ///< largest displacement along x and along y
  SwapCounts adjusting;  ///< counts since the last adjustment
  SwapCounts counts;
  Relaxation relaxation;
  std::optional<AreaChanges> area;  ///< at constant pressure

  Progress(SwapSettings const& wanted, State const& state)
      : settings(wanted),
        adjusting_sweeps(
            wanted.step ? 0 : static_cast<std::uint64_t>(wanted.adjusting * static_cast<double>(wanted.sweeps))),
        diameter(mean_diameter(state.agents)),
        longest_step(0.5 * std::min(state.box.width(), state.box.height())),
        step(std::min(longest_step, diameter * wanted.step.value_or(first_step))),
        relaxation(state, wanted.sweeps - adjusting_sweeps) {
    if (settings.pressure) area.emplace(settings, adjusting_sweeps, state);
  }

  void adjust_step() {
    if (adjusting.displacements < displacements_of_an_adjustment) return;
    double const accepted = *share(adjusting.accepted_displacements, adjusting.displacements);
    step = std::clamp(step * std::clamp(accepted / wanted_acceptance, 0.5, 2.0), min_step * diameter, longest_step);
    adjusting = {};
  }

  void take_sweep(SwapTrials& trials, std::uint64_t seed_of_stage) {
    bool const is_adjusting = sweep < adjusting_sweeps;
    if (sweep == adjusting_sweeps) relaxation.look_at(trials, 0);
    trials.take({.number = seed_of_stage + sweep, .swap_fraction = settings.swap_fraction, .step = step},
                is_adjusting ? adjusting : counts);
    if (area) diameter *= area->take(trials, sweep, seed_of_stage + sweep, counts);
    ++sweep;
    if (is_adjusting) {
      adjust_step();
    } else {
      relaxation.look_at(trials, sweep - adjusting_sweeps);
    }
  }

  [[nodiscard]] std::string missing(SwapReport const& report) const {
    double const sweeps_that_count = static_cast<double>(sweep - std::min(sweep, adjusting_sweeps));
    if (!report.relaxation_times) {
      return fmt::format(
          "{} have not relaxed within {:.0f} sweeps: this is no equilibrium, and how many sweeps that takes is not "
          "known",
          report.overlap_relaxation_time ? "the bond orientations" : "the positions", sweeps_that_count);
    }
    double const time = std::max(*report.overlap_relaxation_time, *report.bond_relaxation_time);
    double const needed = enough_relaxation_times * time * 1.1 * static_cast<double>(settings.sweeps) /
                          static_cast<double>(settings.sweeps - adjusting_sweeps);
    return fmt::format(
        "{:.0f} sweeps are {:.1f} relaxation times of {:.3g} sweeps, and equilibrium takes {:.0f}: use {:.2g} sweeps",
        sweeps_that_count, *report.relaxation_times, time, enough_relaxation_times, needed);
  }
};

SwapMonteCarlo::SwapMonteCarlo(SwapSettings const& settings, State const& state) {
  require_bounds(settings);
  require_rectangle(state.box, "swap Monte Carlo");
  require(!state.agents.empty(), "there are no disks to move", "give at least one", "disks.count");
  double const rounding = rounding_of_contact(state);
  validate(state, {.overlap = rounding, .beyond_walls = rounding});
  progress_ = std::make_unique<Progress>(settings, state);
}

SwapMonteCarlo::~SwapMonteCarlo() = default;
SwapMonteCarlo::SwapMonteCarlo(SwapMonteCarlo&& other) noexcept = default;
SwapMonteCarlo& SwapMonteCarlo::operator=(SwapMonteCarlo&& other) noexcept = default;

bool SwapMonteCarlo::advance(State& state, std::function<bool()> const& should_continue) {
  Progress& progress = *progress_;
  SwapTrials trials(state);
  std::uint64_t const first_number = progress.settings.stage * (max_sweeps + 1);
  while (progress.sweep < progress.settings.sweeps) {
    progress.take_sweep(trials, first_number);
    if (should_continue && !should_continue()) break;
  }
  trials.write_back(state);
  return progress.sweep == progress.settings.sweeps;
}

std::uint64_t SwapMonteCarlo::sweeps_done() const { return progress_->sweep; }

SwapCounts const& SwapMonteCarlo::counts() const { return progress_->counts; }

std::vector<SwapCorrelation> SwapMonteCarlo::correlations() const { return progress_->relaxation.correlations(); }

std::vector<SwapDensity> SwapMonteCarlo::densities() const {
  return progress_->area ? progress_->area->densities() : std::vector<SwapDensity>();
}

SwapReport SwapMonteCarlo::report() const {
  Progress const& progress = *progress_;
  SwapCounts const& counts = progress.counts;
  RelaxationTimes const times = progress.relaxation.times(progress.sweep - progress.adjusting_sweeps);
  SwapReport report{.sweeps = progress.sweep,
                    .step = progress.step / progress.diameter,
                    .displacement_acceptance = share(counts.accepted_displacements, counts.displacements),
                    .swap_acceptance = share(counts.accepted_swaps, counts.swaps),
                    .area_acceptance = share(counts.accepted_area_changes, counts.area_changes),
                    .overlap_relaxation_time = times.overlap,
                    .bond_relaxation_time = times.bond,
                    .relaxation_times = times.in_run};
  std::vector<double> const packing_fractions = packing_fractions_that_count(densities());
  report.density_drift = drift_of(packing_fractions);
  if (!packing_fractions.empty()) report.reduced_pressure = progress.area->reduced_pressure(mean_of(packing_fractions));
  bool const drifts = std::abs(report.density_drift.value_or(0.0)) >= largest_drift;
  report.is_equilibrated = times.is_enough && !drifts;
  if (!times.is_enough) {
    report.warning = progress.missing(report);
  } else if (drifts) {
    report.warning = fmt::format(
        "the packing fraction has not found its mean: from the first to the second half of the sweeps it changes by "
        "{:.2g} "
        "standard deviations; use more sweeps",
        *report.density_drift);
  }
  return report;
}

void SwapMonteCarlo::serialize(Archive& archive, State const& state) {
  Progress& progress = *progress_;
  archive.visit("sweep", progress.sweep);
  archive.visit("diameter", progress.diameter);
  archive.visit("step", progress.step);
  archive.require(progress.sweep <= progress.settings.sweeps, "more sweeps were done than there are");
  archive.require(progress.step > 0.0 && progress.step <= progress.longest_step, "a step is no displacement");
  serialize_inside(archive, "adjusting", [&] { serialize_counts(archive, progress.adjusting); });
  serialize_inside(archive, "counts", [&] { serialize_counts(archive, progress.counts); });
  serialize_inside(archive, "relaxation",
                   [&] { progress.relaxation.serialize(archive, state.agents.size(), progress.sweep); });
  if (progress.area) serialize_inside(archive, "area", [&] { progress.area->serialize(archive, progress.sweep); });
}

}  // namespace gridlock
