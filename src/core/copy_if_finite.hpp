#pragma once

#include <cstddef>
#include <span>

namespace gridlock {

/// Copies numbers, and returns whether none of them is infinite or no number. Contract: `to` has as many (not checked).
[[nodiscard]] bool copy_if_finite(std::span<double const> from, std::span<double> to);

/// Returns the place of the first value that is infinite or no number, or the number of values.
[[nodiscard]] std::size_t find_not_finite(std::span<double const> values);

}  // namespace gridlock
