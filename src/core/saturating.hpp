#pragma once

#include <cstdint>
#include <limits>

namespace gridlock {

/// The largest count: a step that is never_reached reached.
inline constexpr std::uint64_t never_reached = std::numeric_limits<std::uint64_t>::max();

/// a + b, or `never_reached` where the sum is larger than any count.
constexpr std::uint64_t saturating_sum(std::uint64_t a, std::uint64_t b) {
  return b > never_reached - a ? never_reached : a + b;
}

/// The first multiple of `period` above `count`, or `never_reached` where it is larger than any count. Contract: period
/// > 0.
constexpr std::uint64_t next_multiple(std::uint64_t period, std::uint64_t count) {
  return saturating_sum(count - count % period, period);
}

}  // namespace gridlock
