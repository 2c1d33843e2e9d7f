#pragma once

#include <cstdint>
#include <limits>

namespace gridlock {

/// The largest count, for a step that never comes.
inline constexpr std::uint64_t never_reached = std::numeric_limits<std::uint64_t>::max();

/// Returns a + b, or `never_reached` where the sum exceeds the largest count.
constexpr std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
  return b > never_reached - a ? never_reached : a + b;
}

/// Returns the first multiple of `period` above `count`, or `never_reached` where it exceeds the largest count.
/// Contract: period > 0.
constexpr std::uint64_t next_multiple(std::uint64_t period, std::uint64_t count) {
  return saturating_sum(count - count % period, period);
}

}  // namespace gridlock
