#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/observe/estimate.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Returns the area of the part of a disk on one side of a line, at the signed distance `height` from the centre.
///
///     area = r² (π/2 + asin h + h √(1 − h²)),   h = height/r, from −1 (nothing) to 1 (the whole disk)
double area_of_disk_below(double radius, double height);

/// The density along one axis: how many mobile agents are in each of the strips that divide the box, and how much of a
/// strip they cover.
///
///     number_density(bin) = centres in the strip / area of the strip               1 / length²
///     packing_fraction(bin) = area of disks inside the strip / area of the strip   pure number
///
/// A disk that crosses the border of two strips covers a part of each, to the last digit: at a wall the packing
/// fraction goes to 0 within a radius, and the mean of either column over the strips is that of the box. For equal
/// disks the packing fraction by centres, as in an equation of state, is number_density · π r². Disks of infinite mass
/// are fixed, and not counted; the area of the strip includes theirs. Agents without a radius have no packing fraction.
/// The result is the distribution "density_profile_x" or "density_profile_y": position (middle of the strip), both
/// columns, each with an error from blocks of samples. The strips have the sides of the box at each sample, and
/// positions are those of the box at begin().
/// Cost: one pass over the agents, about 20 ns an agent, and 20 ns for each border of strips that a disk crosses.
/// Memory: 1.1 KiB a strip. Source: J.-P. Hansen & I. R. McDonald, Theory of Simple Liquids (2013), chapter 6.
class DensityProfile final : public Observable {
 public:
  enum class Axis { x, y };

  DensityProfile(Axis axis, std::uint64_t bins) : axis_(axis), bins_(bins) {}

  [[nodiscard]] Requirements requirements(Box const& /*box*/) const override { return {.columns = {X::name, Y::name}}; }
  [[nodiscard]] std::vector<ColumnInfo> columns() const override { return {}; }
  void begin(Snapshot const& start) override;
  void sample(Snapshot const& now, std::span<double> row, bool counts_for_average) override;
  [[nodiscard]] std::vector<NamedEstimate> results() const override { return {}; }
  [[nodiscard]] std::vector<Distribution> distributions() const override;
  void serialize(Archive& archive) override;

 private:
  Axis axis_;
  std::uint64_t bins_;
  double side_ = 1.0;  ///< length of the box along the axis at begin()
  bool has_radius_ = false;
  std::vector<BlockAverage> density_;
  std::vector<BlockAverage> covered_;  ///< empty for agents without a radius
};

}  // namespace gridlock
