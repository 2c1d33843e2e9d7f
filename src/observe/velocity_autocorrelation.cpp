#include "gridlock/observe/velocity_autocorrelation.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace gridlock {

std::vector<ColumnInfo> VelocityAutocorrelation::columns() const {
  return {{"velocity_autocorrelation", "", "Σ v(t₀)·v(t) / Σ v(t₀)² since the first sample that counts for averages."}};
}

void VelocityAutocorrelation::begin(Moment const&) {
  has_origin_ = false;
  rows_ = {};
  velocities_.clear();
  curve_.clear();
}

void VelocityAutocorrelation::set_origin(State const& state) {
  Disks const& disks = state.disks;
  has_origin_ = true;
  origin_time_ = state.clock.time;
  rows_ = RowsById(disks.ids());
  velocities_.assign(disks.size(), {});
  for (std::size_t i = 0; i < disks.size(); ++i) velocities_[rows_.place_of(disks.ids()[i], i)] = velocity(disks, i);
}

void VelocityAutocorrelation::sample(Moment const& now, std::span<double> row, bool counts_for_average) {
  row[0] = no_value;
  if (!has_origin_ && counts_for_average) set_origin(now.state);
  if (!has_origin_) return;
  Disks const& disks = now.state.disks;
  auto const ids = disks.ids();
  // With the squares at the origin as weights, the ratio of sums is the normalised correlation.
  std::array<Block, disk_blocks> blocks{};
  for (std::size_t i = 0; i < disks.size(); ++i) {
    std::size_t const place = rows_.place_of(ids[i], i);
    if (place == RowsById::not_found) continue;
    Vector const then = velocities_[place];
    blocks[rows_.block_of(place, disk_blocks)].add({dot(then, velocity(disks, i)), squared_length(then)});
  }
  auto const correlation = estimate_from(blocks);
  if (!correlation) return;
  row[0] = correlation->value;
  curve_.push_back({now.state.clock.time - origin_time_, *correlation});
}

std::vector<Distribution> VelocityAutocorrelation::distributions() const {
  if (curve_.empty()) return {};
  std::vector<double> lag, correlation, error;
  for (Point const& point : curve_) {
    lag.push_back(point.lag);
    correlation.push_back(point.correlation.value);
    error.push_back(point.correlation.error.value_or(no_value));
  }
  return {{.name = "velocity_autocorrelation",
           .columns = {{"lag", "time", "Time since the first sample that counts for averages."},
                       {"velocity_autocorrelation", "", "Σ v(t₀)·v(t) / Σ v(t₀)²."},
                       {"error", "", "One standard error, from blocks of disks."}},
           .columns_of_values = {std::move(lag), std::move(correlation), std::move(error)}}};
}

void VelocityAutocorrelation::carry(Archive& archive) {
  archive.visit("has_origin", has_origin_);
  archive.visit("origin_time", origin_time_);
  carry_inside(archive, "origin", [&] { rows_.carry(archive); });
  std::vector<double> velocities;
  for (Vector const v : velocities_) velocities.insert(velocities.end(), {v.x, v.y});
  archive.visit("velocities", velocities);
  archive.require(velocities.size() == 2 * rows_.size(), "not every disk has a velocity");
  velocities_.resize(rows_.size());
  for (std::size_t k = 0; k < velocities_.size(); ++k) velocities_[k] = {velocities[2 * k], velocities[2 * k + 1]};
  // An error that is absent is written as NaN.
  std::vector<double> curve;
  for (auto const& [lag, correlation] : curve_) {
    curve.insert(curve.end(), {lag, correlation.value, correlation.error.value_or(no_value)});
  }
  archive.visit("curve", curve);
  archive.require(curve.size() % 3 == 0, "a point of the curve is incomplete");
  curve_.clear();
  for (std::size_t k = 0; k < curve.size(); k += 3) {
    Estimate const correlation{curve[k + 1], std::isnan(curve[k + 2]) ? std::nullopt : std::optional(curve[k + 2])};
    curve_.push_back({curve[k], correlation});
  }
}

}  // namespace gridlock
