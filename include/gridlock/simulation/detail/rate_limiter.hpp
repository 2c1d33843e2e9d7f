#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>

namespace gridlock {

/// A rate limiter for loops whose iterations take an unpredictable time: is_due(), called once an iteration, returns
/// true about once every `seconds`. Cost: a count, and a few readings of the clock for each time it returns true.
class RateLimiter {
 public:
  /// `now` returns seconds that never decrease; tests pass a clock of their own.
  explicit RateLimiter(double seconds, std::function<double()> now = seconds_of_steady_clock)
      : seconds_(seconds), now_(std::move(now)), last_look_(now_()), last_reading_(last_look_) {}

  [[nodiscard]] bool is_due() {
    if (++pieces_ < pieces_to_reading_) return false;
    double const now = now_();
    double const each = (now - last_reading_) / static_cast<double>(pieces_);
    pieces_since_look_ += pieces_;
    // Iterations may become slower: the clock is read again after at most twice the iterations of the last period.
    double const most = 2.0 * static_cast<double>(std::max(pieces_since_look_, pieces_between_looks_));
    bool const is_due = now - last_look_ >= seconds_;
    if (is_due) {
      last_look_ = now;
      pieces_between_looks_ = std::exchange(pieces_since_look_, 0);
    }
    double const left = last_look_ + seconds_ - now;
    pieces_to_reading_ = static_cast<std::uint64_t>(std::max(1.0, each * most > left ? left / each : most));
    if (left <= 0.0) pieces_to_reading_ = 1;
    last_reading_ = now;
    pieces_ = 0;
    return is_due;
  }

 private:
  static double seconds_of_steady_clock() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }

  double seconds_;
  std::function<double()> now_;
  double last_look_;
  double last_reading_;
  std::uint64_t pieces_ = 0;  ///< iterations since the clock was last read
  std::uint64_t pieces_to_reading_ = 1;
  std::uint64_t pieces_since_look_ = 0;
  std::uint64_t pieces_between_looks_ = 0;  ///< iterations between the last two times that is_due() returned true
};

}  // namespace gridlock
