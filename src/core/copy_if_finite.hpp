#pragma once

#include <span>

namespace gridlock {

/// Copies numbers, and returns whether none of them is infinite or no number. Contract: `to` has as many (not checked).
[[nodiscard]] bool copy_if_finite(std::span<double const> from, std::span<double> to);

}  // namespace gridlock
