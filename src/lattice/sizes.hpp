#pragma once

#include <cstdint>
#include <functional>

#include "gridlock/lattice/start.hpp"

namespace gridlock {

/// The radii of `count` disks in units of their mean, from the smallest to the largest: the quantiles (k + ½)/count of the
/// distribution of the settings, so that every seed has the same sizes. Additions, multiplications, divisions and square roots
/// alone, so that every compiler gives the same bits.
/// Cost: that of all quantiles, up to a microsecond each, to find the mean; then of one for each size that is asked for.
class Sizes {
 public:
  /// Errors: Error for a spread that the distribution cannot have.
  Sizes(DisksSettings const& settings, std::uint64_t count);

  [[nodiscard]] double at(std::uint64_t k) const { return quantile(k) * scale_; }
  [[nodiscard]] double largest() const { return at(count_ - 1); }

 private:
  [[nodiscard]] double quantile(std::uint64_t k) const {
    return quantile_function_((static_cast<double>(k) + 0.5) / static_cast<double>(count_));
  }

  std::uint64_t count_;
  std::function<double(double)> quantile_function_;
  double scale_ = 1.0;
};

}  // namespace gridlock
