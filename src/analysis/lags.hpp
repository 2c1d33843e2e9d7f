#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

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

}  // namespace gridlock
