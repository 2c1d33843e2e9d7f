#pragma once

/// \file
/// The pair correlation functions of points of several kinds.
///
/// ```cpp
/// std::vector<double> const x{0.1, 0.9, 0.5};
/// std::vector<double> const y{0.5, 0.5, 0.5};
/// PointsInMemory const points{.x = x.data(), .y = y.data(), .count = 3};
/// PairCorrelations const found = find_pair_correlations(Box(1.0, 1.0, Edge::periodic), points, 0.5, 10);
/// double const g = found.of(0, 0)[4];  // the pair that is 0.2 apart, around the edge
/// ```

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// The functions g_ab(r) of all kinds a and b, in bins of equal width.
struct PairCorrelations {
  std::size_t kinds = 1;
  std::vector<double> distance;  ///< the middle of each bin
  std::vector<double> g;         ///< g_ab = g_ba in bin k is at ((a · kinds) + b) · bins + k

  [[nodiscard]] std::span<double const> of(std::size_t a, std::size_t b) const {
    return std::span(g).subspan((a * kinds + b) * distance.size(), distance.size());
  }
};

/// Returns the pair correlation functions of all kinds of points in a periodic box.
///
///     g_ab(r) = pairs of kinds a and b in the bin / (all such pairs · area of the ring / area of the box)
///
/// with N_a N_b pairs of different kinds and N_a (N_a − 1) / 2 pairs of one kind: 1 for an ideal gas, NaN without
/// pairs. `kinds` has one number for each point, from 0; empty: one kind.
/// Errors: Error for a box that is not periodic, a range above half its shorter side, no bins or more than 10⁷ for all
/// pairs of kinds, `kinds` of another length than the points, and points that NeighbourSearch refuses. The result does
/// not depend on `threads` (0: one for each core).
/// Cost: 10 ns a pair in the range (AVX-512, AMD Zen 4). Source: J.-P. Hansen & I. R. McDonald, Theory of Simple
/// Liquids (2013), chapter 2.
PairCorrelations find_pair_correlations(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                        std::span<std::uint32_t const> kinds = {}, std::uint64_t threads = 1);

}  // namespace gridlock
