#include "engine/swap/area.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gridlock/core/detail/exact_sum.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {

namespace {

constexpr std::uint64_t stretches = 1000;
constexpr std::uint64_t trials_of_an_adjustment = 50;
constexpr double accepted_share = 0.4;
constexpr double max_change = 0.05;
constexpr double min_change = 1e-9;

/// Returns ln((1 + η)/(1 − η)) for |η| ≤ 0.05, to the last digits and with the same bits everywhere.
double logarithm_of_ratio(double eta) {
  double const square = eta * eta;
  double sum = 0.0;
  for (double power = 11.0; power >= 1.0; power -= 2.0) sum = sum * square + 1.0 / power;
  return 2.0 * eta * sum;
}

}  // namespace

AreaChanges::AreaChanges(SwapSettings const& settings, std::uint64_t adjusting_sweeps, State const& state)
    : seed_(state.seed),
      adjusting_sweeps_(adjusting_sweeps),
      stretch_((settings.sweeps + stretches - 1) / stretches),
      pressure_(*settings.pressure),
      disks_(static_cast<double>(state.agents.size())) {
  // The bits of exact sums do not depend on the order of the rows.
  ExactSum radii;
  ExactSum squares;
  for (double const radius : state.agents.column<Radius>()) {
    radii.add(radius);
    squares.add(radius * radius);
  }
  double const diameter = 2.0 * radii.value() / disks_;
  area_ = state.box.area() / (diameter * diameter);
  packing_fraction_times_area_ = std::numbers::pi * squares.value() / (diameter * diameter);
}

double AreaChanges::take(SwapTrials& trials, std::uint64_t sweep, std::uint64_t number, SwapCounts& counts) {
  // The trials of the sweep have the random numbers 0 to N − 1.
  RandomStream random(seed_, number, trials.size(), Purpose::swap_trial);
  double const eta = largest_ * (2.0 * random.uniform() - 1.0);
  double const ratio = (1.0 + eta) / (1.0 - eta);
  // Along ln v, in which the trial is symmetric, the weight is v^(N + 1) exp(−P v). A trial is accepted with the
  // probability exp(gain), which is that of an exponential number above −gain.
  double const gain = (disks_ + 1.0) * logarithm_of_ratio(eta) - pressure_ * area_ * (ratio - 1.0);
  double const factor = 1.0 / std::sqrt(ratio);
  bool const is_accepted = gain + random.exponential() > 0.0 && trials.scale_radii(factor);
  if (is_accepted) area_ *= ratio;
  if (sweep < adjusting_sweeps_) {
    ++adjusting_trials_;
    adjusting_accepted_ += is_accepted ? 1U : 0U;
    adjust();
  } else {
    ++counts.area_changes;
    counts.accepted_area_changes += is_accepted ? 1U : 0U;
  }
  note(sweep + 1);
  return is_accepted ? factor : 1.0;
}

void AreaChanges::adjust() {
  if (adjusting_trials_ < trials_of_an_adjustment) return;
  double const share = static_cast<double>(adjusting_accepted_) / static_cast<double>(adjusting_trials_);
  largest_ = std::clamp(largest_ * std::clamp(share / accepted_share, 0.5, 2.0), min_change, max_change);
  adjusting_trials_ = 0;
  adjusting_accepted_ = 0;
}

void AreaChanges::note(std::uint64_t sweeps_done) {
  sum_ += packing_fraction_times_area_ / area_;
  if (sweeps_done % stretch_ != 0) return;
  packing_fractions_.push_back(sum_ / static_cast<double>(stretch_));
  sum_ = 0.0;
}

std::vector<SwapDensity> AreaChanges::densities() const {
  std::vector<SwapDensity> densities;
  for (std::uint64_t k = 0; k < packing_fractions_.size(); ++k) {
    densities.push_back({.sweep = (k + 1) * stretch_,
                         .packing_fraction = packing_fractions_[k],
                         .is_adjusting = k * stretch_ < adjusting_sweeps_});
  }
  return densities;
}

double AreaChanges::reduced_pressure(double packing_fraction) const {
  return pressure_ * packing_fraction_times_area_ / (disks_ * packing_fraction);
}

void AreaChanges::serialize(Archive& archive, std::uint64_t sweeps_done) {
  archive.visit("area", area_);
  archive.visit("packing_fraction_times_area", packing_fraction_times_area_);
  archive.visit("largest", largest_);
  archive.visit("adjusting_trials", adjusting_trials_);
  archive.visit("adjusting_accepted", adjusting_accepted_);
  archive.visit("sum", sum_);
  archive.visit("packing_fractions", packing_fractions_);
  archive.require(area_ > 0.0 && std::isfinite(area_), "an area is not positive");
  archive.require(packing_fraction_times_area_ > 0.0, "a packing fraction is not positive");
  archive.require(largest_ >= min_change && largest_ <= max_change, "a change of the area is out of bounds");
  archive.require(packing_fractions_.size() == sweeps_done / stretch_, "packing fractions of sweeps are missing");
}

}  // namespace gridlock
