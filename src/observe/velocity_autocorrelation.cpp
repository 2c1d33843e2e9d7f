#include "gridlock/observe/velocity_autocorrelation.hpp"

#include <array>
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

}  // namespace gridlock
