#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/observe/estimate.hpp"

namespace gridlock {

/// The pairs of frames with the same lag, in the order of their origins.
class FramesOfLag {
 public:
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Takes the pairs that are `offset` frames apart, of `frames` frames at even times.
  FramesOfLag(double lag, std::size_t offset, std::size_t frames)
      : lag_(lag), offset_(offset), count_(frames - offset) {}
  FramesOfLag(double lag, std::vector<Pair> pairs) : lag_(lag), count_(pairs.size()), pairs_(std::move(pairs)) {}

  [[nodiscard]] double lag() const { return lag_; }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] std::pair<std::size_t, std::size_t> operator[](std::size_t k) const {
    if (pairs_.empty()) return {k, k + offset_};
    return pairs_[k];
  }

 private:
  double lag_;
  std::size_t offset_ = 0;
  std::size_t count_;
  std::vector<Pair> pairs_;  ///< empty where frames are at even times
};

/// Returns the lags above 0 between frames at ascending times, in ascending order. Lags that differ by less than a
/// thousandth of the shortest time between frames are one lag. Of more than `most` lags only those nearest to values
/// evenly spaced in the logarithm are returned; `most` = 0 returns all.
/// Errors: Error for fewer than two frames, for times that do not ascend or are not finite, and for too many frames at
/// uneven times.
std::vector<FramesOfLag> lags_between(std::span<double const> times, std::size_t most);

/// Returns which pairs of a lag are independent: pairs whose intervals do not overlap, chosen from the first on.
std::vector<bool> independent_pairs(FramesOfLag const& frames, std::span<double const> times);

/// Returns the pairs of frames whose lag is nearest to `lag`; for 0 each frame with itself. Of more than `max_origins`
/// pairs so many are returned, evenly spread; `max_origins` = 0 returns all. `lags` comes from lags_between().
/// Errors: Error for a lag below 0, and for one beyond the last frame.
FramesOfLag frames_nearest(std::span<FramesOfLag const> lags, std::span<double const> times, double lag,
                           std::size_t max_origins);

/// Returns the mean of values, one for each pair of a lag, with its error from the independent pairs.
Estimate mean_over_origins(std::span<double const> values, std::vector<bool> const& independent);

/// Returns the variance of values, one for each pair of a lag, from all pairs of values whose intervals do not overlap;
/// it is unbiased if such values are independent.
///
///     variance = ½ ⟨(v_a − v_b)²⟩
///
/// Its error comes from the values of independent pairs of frames; it is somewhat too large, as for all means over
/// origins. Without two intervals that do not overlap the value is NaN. Cost: O(pairs).
Estimate variance_over_origins(FramesOfLag const& frames, std::span<double const> times,
                               std::vector<bool> const& independent, std::vector<double> values);

}  // namespace gridlock
