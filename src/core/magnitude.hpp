#pragma once

#include <optional>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"

namespace gridlock {

/// Bounds of lengths, speeds and masses: engines multiply up to four of them and divide by four more.
inline constexpr double min_magnitude = 1e-60;
inline constexpr double max_magnitude = 1e60;
inline constexpr char const* magnitude_hint =
    "lengths, masses and the largest speed lie from 1e-60 to 1e60; choose other units";

inline bool has_bounded_magnitude(double value) { return value >= min_magnitude && value <= max_magnitude; }

/// Returns the reason why a box cannot be used: sides too large, too small, or too different from each other.
std::optional<Problem> find_extreme_sides(Box const& box);

}  // namespace gridlock
