#pragma once

#include <cstddef>
#include <span>

#include "gridlock/core/box.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Errors: Error for a cutoff that is negative or not a number.
void require_cutoff(double cutoff);

/// Errors: Error for lists of coordinates of different lengths, and for coordinates that are not finite.
void require_points(std::span<double const> x, std::span<double const> y);

/// Errors: Error for lists of coordinates of different lengths.
void require_equal_lengths(std::span<double const> x, std::span<double const> y);

/// Errors: Error for a point that is not finite; `i` is its index.
void require_finite_point(std::size_t i, Vector p);

/// Errors: Error for a cutoff outside 10⁻⁶⁰ … 10⁶⁰.
void require_bounded_cutoff(double cutoff);

/// Errors: Error for a box with sides outside 10⁻⁶⁰ … 10⁶⁰, and for a cutoff above half a side of a periodic box.
void require_box_for(Box const& box, double cutoff);

/// Errors: Error for more points than a search can hold.
void require_point_count(std::size_t points);

/// Errors: Error for coordinates that are not finite, and for more points than a search can hold.
void require_points_in_memory(PointsInMemory const& points);

/// Errors: those of require_points_in_memory() and of require_bounded_cutoff().
void require_search(PointsInMemory const& points, double cutoff);

/// Errors: Error for a number of radii other than `count`, and for radii outside 10⁻⁶⁰ … 10⁶⁰.
void require_radii(std::span<double const> radius, std::size_t count);

/// Errors: Error for a factor that is not above 0, a gap below 0, and for values that are not numbers.
void require_reach(DiskReach const& reach);

/// Errors: Error where a grid holds agents for which the lists have no coordinates.
void require_all_moved(std::size_t moved, std::size_t held, std::size_t coordinates);

}  // namespace gridlock
