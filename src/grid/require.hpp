#pragma once

#include <cstddef>
#include <span>

namespace gridlock {

/// Errors: Error for a cutoff that is negative or no number.
void require_cutoff(double cutoff);

/// Errors: Error for lists of coordinates of different lengths, and for coordinates that are not finite.
void require_points(std::span<double const> x, std::span<double const> y);

/// Errors: Error for lists of coordinates of different lengths.
void require_equal_lengths(std::span<double const> x, std::span<double const> y);

/// Errors: Error where a grid holds more agents than the lists have coordinates for.
void require_all_moved(std::size_t moved, std::size_t held, std::size_t coordinates);

}  // namespace gridlock
