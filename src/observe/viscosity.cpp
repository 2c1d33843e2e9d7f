#include "observe/viscosity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "gridlock/core/error.hpp"
#include "observe/motion.hpp"
#include "observe/stress.hpp"

namespace gridlock {

namespace {

// Indices of columns.
constexpr std::size_t xx_column = 0;
constexpr std::size_t xy_column = 1;
constexpr std::size_t yy_column = 2;
constexpr std::size_t shear_column = 3;
constexpr std::size_t bulk_column = 4;

}  // namespace

Viscosity::Viscosity(std::uint64_t max_lag)
    : max_lag_(max_lag), origins_of_group_(4 * max_lag), integrals_(2 * max_lag + 1) {
  for (std::uint64_t const samples : lags_of_curve(max_lag)) {
    lags_.push_back({.samples = samples, .shear = {}, .bulk = {}, .correlation = {}});
  }
}

void Viscosity::begin(Snapshot const& start) {
  if (!start.box.is_periodic()) {
    throw Error({.what = "observe.viscosity_lag needs a box that is periodic in x and y",
                 .hint = "use box.edge = \"periodic\": walls take momentum from the disks",
                 .key = "observe.viscosity_lag"});
  }
  if (count_of_moving(start) < start.count()) {
    throw Error({.what = "observe.viscosity_lag needs disks that all move",
                 .hint = "let no species be fixed: fixed disks take momentum from the others",
                 .key = "observe.viscosity_lag"});
  }
  std::vector<ColumnInfo> columns = stress_columns();
  columns.push_back(
      {"shear_viscosity", "mass / time", "Slope of the shear growth, from the origin whose lags end in this sample."});
  columns.push_back(
      {"bulk_viscosity", "mass / time", "Slope of the bulk growth, from the origin whose lags end in this sample."});
  reset(std::move(columns));
  for (Lag& lag : lags_) lag = {.samples = lag.samples, .shear = {}, .bulk = {}, .correlation = {}};
  shear_viscosity_ = bulk_viscosity_ = {};
  last_time_ = start.clock.time;
  collisions_ = {};
  interval_ = 0.0;
  taken_ = 0;
}

Viscosity::Tensor Viscosity::product(Vector a, Vector b) {
  double const xx = a.x * b.x;
  double const yy = a.y * b.y;
  return {.xy = 0.5 * (a.x * b.y + a.y * b.x), .difference = 0.5 * (xx - yy), .mean = 0.5 * (xx + yy)};
}

void Viscosity::collided(PairCollision const& collision) {
  Vector const impulse = collision.impulse;
  Vector const relative = collision.velocity_j - collision.velocity_i;
  double const per_mass = 0.5 / collision.mass_i + 0.5 / collision.mass_j;
  double const elapsed = collision.time - last_time_;
  // The momenta change by ∓J, so that Σ m v_a v_b changes by J_a w_b + w_a J_b + J_a J_b (1/m_i + 1/m_j).
  Tensor const change = product(impulse, relative + per_mass * impulse);
  Tensor const moment = product(impulse, collision.separation);
  collisions_.xy += moment.xy - 2.0 * elapsed * change.xy;
  collisions_.difference += moment.difference - 2.0 * elapsed * change.difference;
  collisions_.mean += moment.mean;  // an elastic collision keeps Σ m v²
}

/// Returns Σ m v_a v_b relative to the centre.
Viscosity::Tensor Viscosity::sum_of_motion(Snapshot const& now) {
  auto const mass = now.agents.column<Mass>();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  auto const [xy, xx, yy, x, y, all] = now.sum([&](std::size_t i) {
    double const m = mass[i];
    double const vx = velocity_x[i];
    double const vy = velocity_y[i];
    return std::array{m * vx * vy, m * vx * vx, m * vy * vy, m * vx, m * vy, m};
  });
  Tensor const of_centre = product({x, y}, {x / all, y / all});
  return {.xy = xy - of_centre.xy,
          .difference = 0.5 * (xx - yy) - of_centre.difference,
          .mean = 0.5 * (xx + yy) - of_centre.mean};
}

void Viscosity::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  std::ranges::fill(row, no_value);
  double const duration = now.clock.time - last_time_;
  Tensor const growth = std::exchange(collisions_, {});
  last_time_ = now.clock.time;
  auto const temperature = measured_temperature(now);
  if (!(duration > 0.0) || !temperature || !(*temperature > 0.0)) return;
  Tensor const motion = sum_of_motion(now);
  Tensor const grown{.xy = duration * motion.xy + growth.xy,
                     .difference = duration * motion.difference + growth.difference,
                     .mean = duration * motion.mean + growth.mean};
  double const area = now.box.area();
  row[xx_column] = -(grown.mean + grown.difference) / (area * duration);
  row[xy_column] = -grown.xy / (area * duration);
  row[yy_column] = -(grown.mean - grown.difference) / (area * duration);
  if (!counts_for_average) return;
  for (std::size_t const column : {xx_column, xy_column, yy_column}) average(column, row[column], duration);
  remember(grown, duration);
  if (taken_ > 0) take_lags(area, *temperature, row);
}

/// Adds an interval to the integrals. One of another length, such as the last of a run, ends their row.
void Viscosity::remember(Tensor const& growth, double duration) {
  if (interval_ == 0.0) interval_ = duration;
  if (std::abs(duration - interval_) > 1e-6 * interval_) {
    taken_ = 0;
    return;
  }
  if (taken_ == 0) integrals_[taken_++] = {};
  Tensor const& last = integral_before(0);
  integrals_[taken_ % integrals_.size()] = {
      .xy = last.xy + growth.xy, .difference = last.difference + growth.difference, .mean = last.mean + growth.mean};
  ++taken_;
}

Viscosity::Tensor const& Viscosity::integral_before(std::uint64_t samples) const {
  return integrals_[(taken_ - 1 - samples) % integrals_.size()];
}

/// Takes the lags of the origin that lies `lag` before the last sample, for each lag.
void Viscosity::take_lags(double area, double temperature, std::span<double> row) {
  auto const second_difference = [this](std::uint64_t lag, double Tensor::*component) {
    auto const at = [&](std::uint64_t samples) { return integral_before(samples).*component; };
    return at(0) - 2.0 * at(lag) + at(2 * lag);
  };
  auto const step = [this](std::uint64_t before, double Tensor::*component) {
    return integral_before(before).*component - integral_before(before + 1).*component;
  };
  double const scale = 1.0 / (area * temperature);
  double early_shear = no_value;
  double early_bulk = no_value;
  for (Lag& lag : lags_) {
    std::uint64_t const samples = lag.samples;
    if (2 * samples + 1 > taken_) break;
    double const xy = second_difference(samples, &Tensor::xy);
    double const unlike = second_difference(samples, &Tensor::difference);
    double const mean = second_difference(samples, &Tensor::mean);
    double const shear = 0.125 * scale * (xy * xy + unlike * unlike);
    double const bulk = 0.25 * scale * mean * mean;
    double const products = step(0, &Tensor::xy) * step(samples, &Tensor::xy) +
                            step(0, &Tensor::difference) * step(samples, &Tensor::difference);
    lag.shear.add(shear, origins_of_group_);
    lag.bulk.add(bulk, origins_of_group_);
    lag.correlation.add(0.5 * scale * products / (interval_ * interval_), origins_of_group_);
    if (samples == max_lag_ && max_lag_ > 1) {
      double const time = static_cast<double>(max_lag_ - early_lag_of(max_lag_)) * interval_;
      row[shear_column] = (shear - early_shear) / time;
      row[bulk_column] = (bulk - early_bulk) / time;
      shear_viscosity_.add(row[shear_column], origins_of_group_);
      bulk_viscosity_.add(row[bulk_column], origins_of_group_);
    }
    if (samples != early_lag_of(max_lag_)) continue;
    early_shear = shear;
    early_bulk = bulk;
  }
}

std::vector<NamedEstimate> Viscosity::results() const {
  std::vector<NamedEstimate> results = AveragingObservable::results();
  auto const add = [&](std::size_t column, MeanOverOrigins const& mean) {
    if (auto const estimate = mean.estimate()) {
      results.push_back({columns()[column].name, *estimate, columns()[column].unit});
    }
  };
  add(shear_column, shear_viscosity_);
  add(bulk_column, bulk_viscosity_);
  return results;
}

std::vector<Distribution> Viscosity::distributions() const {
  std::vector<std::vector<double>> values(7);
  for (Lag const& lag : lags_) {
    if (!lag.shear.estimate()) continue;
    values[0].push_back(static_cast<double>(lag.samples) * interval_);
    std::size_t column = 1;
    for (MeanOverOrigins const* const mean : {&lag.shear, &lag.bulk, &lag.correlation}) {
      Estimate const estimate = *mean->estimate();
      values[column++].push_back(estimate.value);
      values[column++].push_back(estimate.error.value_or(no_value));
    }
  }
  if (values[0].empty()) return {};
  return {{.name = "stress_growth",
           .columns = {{"lag", "time", "Time on either side of an origin."},
                       {"shear_growth", "mass", "Growth of the integrated shear stress; its slope is the viscosity."},
                       {"shear_error", "mass", "One standard error, from groups of neighbouring origins."},
                       {"bulk_growth", "mass", "Growth of the integrated pressure; its slope is the bulk viscosity."},
                       {"bulk_error", "mass", "One standard error, from groups of neighbouring origins."},
                       {"stress_autocorrelation", "mass / time²",
                        "A/kT times the mean product of shear stresses a lag apart, each a mean between samples."},
                       {"autocorrelation_error", "mass / time²", "One standard error, from groups of origins."}},
           .columns_of_values = std::move(values)}};
}

void Viscosity::serialize(Archive& archive) {
  AveragingObservable::serialize(archive);
  archive.visit("last_time", last_time_);
  archive.visit("interval", interval_);
  archive.visit("taken", taken_);
  std::vector<double> numbers{collisions_.xy, collisions_.difference, collisions_.mean};
  for (Tensor const& g : integrals_) numbers.insert(numbers.end(), {g.xy, g.difference, g.mean});
  archive.visit("integrals", numbers);
  archive.require(numbers.size() == 3 * (integrals_.size() + 1), "the integrals of stresses differ in number");
  auto const tensor = [&](std::size_t k) { return Tensor{numbers[3 * k], numbers[3 * k + 1], numbers[3 * k + 2]}; };
  collisions_ = tensor(0);
  for (std::size_t k = 0; k < integrals_.size(); ++k) integrals_[k] = tensor(k + 1);
  std::vector<MeanOverOrigins> means{shear_viscosity_, bulk_viscosity_};
  for (Lag const& lag : lags_) means.insert(means.end(), {lag.shear, lag.bulk, lag.correlation});
  gridlock::serialize(archive, "means", means);
  shear_viscosity_ = means[0];
  bulk_viscosity_ = means[1];
  for (std::size_t k = 0; k < lags_.size(); ++k) {
    lags_[k] = {.samples = lags_[k].samples,
                .shear = means[3 * k + 2],
                .bulk = means[3 * k + 3],
                .correlation = means[3 * k + 4]};
  }
}

}  // namespace gridlock
