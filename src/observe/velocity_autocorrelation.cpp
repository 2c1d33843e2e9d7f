#include "observe/velocity_autocorrelation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace gridlock {

std::vector<ColumnInfo> VelocityAutocorrelation::columns() const {
  return {{"velocity_autocorrelation", "", "Σ v(t₀)·v(t) / Σ v(t₀)² since the last origin t₀."}};
}

void VelocityAutocorrelation::begin(Snapshot const& start) {
  has_origin_ = false;
  velocities_ = start.attached<Vector>();
  blocks_.reset();
  curve_.clear();
  over_origins_.clear();
}

void VelocityAutocorrelation::set_origin(Snapshot const& now) {
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  has_origin_ = true;
  samples_since_origin_ = 0;
  origin_time_ = now.clock.time;
  velocities_ = now.attached<Vector>([&](std::size_t i) { return Vector{velocity_x[i], velocity_y[i]}; });
  blocks_.reset();
}

void VelocityAutocorrelation::sample(Snapshot const& now, std::span<double> row, bool counts_for_average) {
  row[0] = no_value;
  if (!has_origin_ && !counts_for_average) return;
  bool const is_origin_due = !has_origin_ || (origin_every_ > 0 && samples_since_origin_ == origin_every_);
  if (is_origin_due) set_origin(now);
  if (!blocks_) blocks_ = IdBlocks(now, velocities_.agents());
  std::size_t const point = samples_since_origin_++;
  auto const ids = now.agents.ids();
  auto const velocity_x = now.agents.column<VelocityX>();
  auto const velocity_y = now.agents.column<VelocityY>();
  // Weighted by the squares at the origin, the ratio of sums is the normalised correlation.
  SumsOfBlocks<agent_blocks, 2> terms;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Vector const* const then = velocities_.find(ids[i], i);
    if (then == nullptr) continue;
    terms.add(blocks_->block_of(ids[i]), {dot(*then, {velocity_x[i], velocity_y[i]}), squared_length(*then)});
  }
  std::vector<ExactSum> sums = terms.take_all();
  now.sum(sums);
  std::array<Block, agent_blocks> blocks{};
  for (std::size_t b = 0; b < agent_blocks; ++b) blocks[b] = {sums[2 * b].value(), sums[2 * b + 1].value()};
  auto const correlation = estimate_from(blocks);
  if (!correlation) return;
  row[0] = correlation->value;
  double const lag = now.clock.time - origin_time_;
  if (point == curve_.size()) curve_.push_back({lag, *correlation});
  // The last sample of a run may come early and then belongs to no point of the curve.
  bool const is_on_curve = point < curve_.size() && std::abs(lag - curve_[point].lag) <= 1e-9 * lag;
  if (origin_every_ == 0 || !is_on_curve) return;
  over_origins_.resize(curve_.size());
  Block all;
  for (Block const& block : blocks) all.add(block);
  over_origins_[point].add(correlation->value, all.weight);
}

Estimate VelocityAutocorrelation::correlation_at(std::size_t place) const {
  if (place < over_origins_.size() && over_origins_[place].samples() > 1) return *over_origins_[place].estimate();
  return curve_[place].correlation;
}

std::vector<Distribution> VelocityAutocorrelation::distributions() const {
  if (curve_.empty()) return {};
  std::vector<double> lag, correlation, error;
  for (std::size_t k = 0; k < curve_.size(); ++k) {
    Estimate const point = correlation_at(k);
    lag.push_back(curve_[k].lag);
    correlation.push_back(point.value);
    error.push_back(point.error.value_or(no_value));
  }
  return {{.name = "velocity_autocorrelation",
           .columns = {{"lag", "time", "Time since an origin t₀."},
                       {"velocity_autocorrelation", "", "Σ v(t₀)·v(t₀ + t) / Σ v(t₀)², over all origins."},
                       {"error", "", "One standard error, from blocks of origins, or of agents where there is one."}},
           .columns_of_values = {std::move(lag), std::move(correlation), std::move(error)}}};
}

void VelocityAutocorrelation::serialize(Archive& archive) {
  archive.visit("has_origin", has_origin_);
  archive.visit("samples_since_origin", samples_since_origin_);
  archive.visit("origin_time", origin_time_);
  serialize_inside(archive, "origin", [&] { velocities_.serialize_ids(archive); });
  velocities_.serialize_member(archive, VelocityX::name, &Vector::x);
  velocities_.serialize_member(archive, VelocityY::name, &Vector::y);
  if (archive.is_restoring()) blocks_.reset();
  // NaN stands for an absent error.
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
  std::uint64_t points = over_origins_.size();
  archive.visit("points", points);
  archive.require(points == 0 || points == curve_.size(), "the curve and its averages differ in length");
  over_origins_.resize(points);
  gridlock::serialize(archive, "over_origins", over_origins_);
}

}  // namespace gridlock
