#include "observe/density_profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/exact_sum.hpp"
#include "observe/mobile.hpp"

namespace gridlock {

double area_of_disk_below(double radius, double height) {
  double const h = std::clamp(height / radius, -1.0, 1.0);
  return radius * radius * (0.5 * std::numbers::pi + std::asin(h) + h * std::sqrt((1.0 - h) * (1.0 + h)));
}

namespace {

/// Strips of equal width from 0 to the side of a box.
struct Strips {
  double width;
  std::int64_t count;
  bool is_periodic;

  [[nodiscard]] std::size_t of(double position) const {
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(position / width)), 0, count - 1));
  }
  /// Adds to each strip the area of a disk that is inside it; what is beyond a wall is left out.
  void add_area(double position, double radius, std::vector<ExactSum>& areas) const {
    if (!(radius > 0.0)) return;
    auto first = static_cast<std::int64_t>(std::floor((position - radius) / width));
    auto last = static_cast<std::int64_t>(std::floor((position + radius) / width));
    if (!is_periodic) {
      first = std::max<std::int64_t>(first, 0);
      last = std::min(last, count - 1);
    }
    double below = area_of_disk_below(radius, static_cast<double>(first) * width - position);
    for (std::int64_t strip = first; strip <= last; ++strip) {
      double const next = area_of_disk_below(radius, static_cast<double>(strip + 1) * width - position);
      areas[static_cast<std::size_t>((strip % count + count) % count)].add(next - below);
      below = next;
    }
  }
};

}  // namespace

void DensityProfile::begin(Snapshot const& start) {
  side_ = axis_ == Axis::x ? start.box.width() : start.box.height();
  has_radius_ = start.agents.has<Radius>();
  density_.assign(bins_, {});
  covered_.assign(has_radius_ ? bins_ : 0, {});
}

void DensityProfile::sample(Snapshot const& now, std::span<double> /*row*/, bool counts_for_average) {
  if (!counts_for_average) return;
  Box const& box = now.box;
  double const side = axis_ == Axis::x ? box.width() : box.height();
  Strips const strips{.width = side / static_cast<double>(bins_),
                      .count = static_cast<std::int64_t>(bins_),
                      .is_periodic = axis_ == Axis::x ? box.is_periodic_x() : box.is_periodic_y()};
  auto const position = axis_ == Axis::x ? now.agents.column<X>() : now.agents.column<Y>();
  MobileAgents const mobile(now.agents);
  std::vector<std::uint64_t> counts(bins_, 0);
  std::vector<ExactSum> areas(covered_.size());
  std::span<double const> radius;
  if (has_radius_) radius = now.agents.column<Radius>();
  for (std::size_t i = 0; i < now.agents.size(); ++i) {
    if (!mobile.has(i)) continue;
    ++counts[strips.of(position[i])];
    if (has_radius_) strips.add_area(position[i], radius[i], areas);
  }
  now.counts(counts);
  now.sum(areas);
  double const strip_area = box.area() / static_cast<double>(bins_);
  for (std::size_t b = 0; b < density_.size(); ++b) density_[b].add(static_cast<double>(counts[b]) / strip_area);
  for (std::size_t b = 0; b < covered_.size(); ++b) covered_[b].add(areas[b].value() / strip_area);
}

std::vector<Distribution> DensityProfile::distributions() const {
  if (density_.empty() || density_.front().samples() == 0) return {};
  std::vector<std::vector<double>> values(has_radius_ ? 5 : 3);
  auto const add = [&](std::size_t column, Estimate const& estimate) {
    values[column].push_back(estimate.value);
    values[column + 1].push_back(estimate.error.value_or(no_value));
  };
  for (std::size_t b = 0; b < density_.size(); ++b) {
    values[0].push_back((static_cast<double>(b) + 0.5) * side_ / static_cast<double>(density_.size()));
    add(1, *density_[b].estimate());
    if (has_radius_) add(3, *covered_[b].estimate());
  }
  std::vector<ColumnInfo> columns{
      {"position", "length", "Middle of the strip."},
      {"number_density", "1 / length²", "Centres of mobile agents in the strip per area."},
      {"error", "1 / length²", "One standard error of the number density, from blocks of samples."}};
  if (has_radius_) {
    columns.push_back({"packing_fraction", "", "Share of the strip that mobile disks cover."});
    columns.push_back(
        {"packing_fraction_error", "", "One standard error of the packing fraction, from blocks of samples."});
  }
  return {{.name = axis_ == Axis::x ? "density_profile_x" : "density_profile_y",
           .columns = std::move(columns),
           .columns_of_values = std::move(values)}};
}

void DensityProfile::serialize(Archive& archive) {
  gridlock::serialize(archive, "density", density_);
  gridlock::serialize(archive, "covered", covered_);
}

}  // namespace gridlock
