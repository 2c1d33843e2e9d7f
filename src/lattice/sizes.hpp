#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "gridlock/lattice/start.hpp"
#include "gridlock/parallel/share_of_rows.hpp"

namespace gridlock {

/// The radii of `count` disks in units of their mean, from the smallest to the largest: the quantiles (k + ½)/count of
/// the distribution of the settings, so that every seed has the same sizes. Additions, multiplications, divisions and
/// square roots alone, so that every compiler gives the same bits.
/// Cost: that of the quantiles of the rows of a share, up to a microsecond each, to find the mean; then of one for each
/// other size that is asked for. Memory: 8 bytes for each row of the share.
class Sizes {
 public:
  /// All processes call it. Errors: Error, in all of them, for a spread that the distribution cannot have.
  Sizes(DisksSettings const& settings, ShareOfRows const& share);

  [[nodiscard]] double at(std::uint64_t k) const { return quantile(k) * scale_; }
  [[nodiscard]] double largest() const { return at(count_ - 1); }

 private:
  [[nodiscard]] double quantile(std::uint64_t k) const {
    if (first_ <= k && k < first_ + of_share_.size()) return of_share_[k - first_];
    return quantile_function_((static_cast<double>(k) + 0.5) / static_cast<double>(count_));
  }

  std::uint64_t count_;
  std::uint64_t first_;
  std::function<double(double)> quantile_function_;
  std::vector<double> of_share_;  ///< as far as they are known: the quantiles from first_ on
  double scale_ = 1.0;
};

}  // namespace gridlock
