#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

bool are_equal(DisksSettings const& settings);

/// Sizes of disks in units of disks.radius, and masses. Equal disks take no memory, others 16 bytes each.
class Kinds {
 public:
  /// Assigns kinds to `count` rows at random; all assignments are equally likely.
  /// Errors: Error for settings that contradict each other.
  Kinds(DisksSettings const& settings, std::uint64_t count, std::uint64_t seed);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] double largest_ratio() const { return largest_ratio_; }
  [[nodiscard]] double sum_of_squared_ratios() const { return sum_of_squared_ratios_; }

  [[nodiscard]] double size_ratio(std::uint64_t row) const { return size_ratios_.empty() ? 1.0 : size_ratios_[row]; }
  [[nodiscard]] double mass(std::uint64_t row) const { return masses_.empty() ? 1.0 : masses_[row]; }

 private:
  void put_in_order(DisksSettings const& settings);
  void deal(std::uint64_t seed);

  std::uint64_t count_;
  double largest_ratio_ = 1.0;
  double sum_of_squared_ratios_ = 0.0;
  std::vector<double> size_ratios_;
  std::vector<double> masses_;
};

}  // namespace gridlock
