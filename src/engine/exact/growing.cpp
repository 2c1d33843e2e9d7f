#include <algorithm>
#include <cmath>

#include "engine/exact/dynamics.hpp"

namespace gridlock::exact {

namespace {

/// Hits of each disk in an epoch, on average, where disks are hit often.
constexpr double hits_in_epoch = 64.0;

}  // namespace

void Dynamics::start_growing(double rate) {
  if (radius_.empty()) {
    radius_.assign(size_ + 1, equal_radius_);
    mass_.assign(size_, equal_mass_);
  }
  growth_.scale.rate = rate;
}

void Dynamics::renew(double factor_of_velocities) {
  double length = epoch_length_;
  std::uint64_t const hits = hits_ - hits_before_epoch_;
  if (hits >= 2 * size_) {
    double const longer = hits_in_epoch * static_cast<double>(size_) / static_cast<double>(hits);
    double const duration = now_ * longer / factor_of_velocities;
    if (duration > 0.0) length = std::min(power_of_two_below(duration), longest_epoch_);
  }
  begin_epoch(now_, length, factor_of_velocities);
}

void Dynamics::serialize_growth(Archive& archive) {
  std::vector<double> radius;
  std::vector<Index> const disks = disks_by_id_index();
  for (Index const i : disks) radius.push_back(radius_[i]);
  archive.visit("radius", radius);
  archive.visit("growth_rate", growth_.scale.rate);
  archive.visit("scale", growth_.scale.at_zero);
  archive.visit("scale_rest", growth_.scale.rest);
  archive.visit("measured_time", growth_.measured_time);
  archive.visit("measured_virial", growth_.measured_virial);
  if (!archive.is_restoring()) return;
  archive.require(radius.size() == size_, "the engine has other disks than the state");
  mean_squared_radius_ = 0.0;
  for (std::size_t id_index = 0; id_index < size_; ++id_index) {
    archive.require(radius[id_index] > 0.0, "a disk cannot be so");
    radius_[disks[id_index]] = radius[id_index];
    mean_squared_radius_ += radius[id_index] * radius[id_index] / static_cast<double>(size_);
  }
  largest_radius_ = std::ranges::max(radii());
  smallest_radius_ = std::ranges::min(radii());
  archive.require(growth_.scale.rate > 0.0 && growth_.scale.at_zero >= 1.0, "the disks do not grow");
}

}  // namespace gridlock::exact
