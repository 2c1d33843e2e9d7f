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

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// The functions g_ab(r) of all kinds a and b, in bins of equal width.
struct PairCorrelations {
  std::size_t kinds = 1;
  std::vector<double> distance;  ///< the middle of each bin
  std::vector<double> g;         ///< g_ab = g_ba in bin k is at ((a · kinds) + b) · bins + k
  /// The correlation of the orders of the two points of a pair, laid out as g; empty without orders.
  std::vector<double> order_correlation;

  [[nodiscard]] std::span<double const> of(std::size_t a, std::size_t b) const {
    return std::span(g).subspan((a * kinds + b) * distance.size(), distance.size());
  }
};

/// Returns the pair correlation functions of all kinds of points in a periodic box.
///
///     g_ab(r) = pairs of kinds a and b in the bin / (all such pairs · area of the ring / area of the box)
///     C_ab(r) = mean of Re ψ_i* ψ_j over the pairs in the bin
///
/// with N_a N_b pairs of different kinds and N_a (N_a − 1) / 2 pairs of one kind: 1 for an ideal gas, NaN without
/// pairs. `kinds` has one number for each point, from 0; empty: one kind. `orders` has the complex order ψ of each
/// point; empty: no C. With ψ = ψ6 of bond_orientations(), C is the hexatic correlation g₆(r), which decays to a
/// constant in a crystal, as a power of r in a hexatic, and exponentially in a liquid; with ψ = exp(i G·r) at the Bragg
/// peak G of find_structure_peak() it is the positional correlation c_G(r). A bin without pairs has no C, but NaN.
/// Errors: Error for a box that is not periodic, a range above half its shorter side, no bins or more than 10⁷ for all
/// pairs of kinds, `kinds` or `orders` of another length than the points, orders that are not finite, and points that
/// NeighbourSearch refuses. The result does not depend on `threads` (0: one for each core). A product ψ_i* ψ_j is
/// rounded to N² · 2⁻⁵⁹ of the largest |ψ|², 2e-8 for 10⁵ points, so that sums are exact.
/// Cost: 5 ns a pair in the range, 6 ns with orders (AVX-512, AMD Zen 4). Sources: J.-P. Hansen & I. R.
/// McDonald, Theory of Simple Liquids (2013), chapter 2; g₆: D. R. Nelson & B. I. Halperin (1979),
/// doi:10.1103/PhysRevB.19.2457; g₆ and c_G: E. P. Bernard & W. Krauth (2011), doi:10.1103/PhysRevLett.107.155704.
PairCorrelations find_pair_correlations(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                        std::span<std::uint32_t const> kinds = {}, std::uint64_t threads = 1,
                                        std::span<std::complex<double> const> orders = {});

/// g(x, y) in a grid of rectangles around the origin, and the correlation of orders there.
struct PairCorrelationMap {
  std::vector<double> x;                  ///< middles of the columns, along the given direction
  std::vector<double> y;                  ///< middles of the rows, to the left of it
  std::vector<double> g;                  ///< of row r and column c at r · columns + c
  std::vector<double> order_correlation;  ///< laid out as g; empty without orders
};

/// The grid of a PairCorrelationMap.
struct MapGrid {
  Vector half;  ///< the grid reaches from −half to +half
  std::size_t columns = 1;
  std::size_t rows = 1;    ///< one row: g along a line, from pairs in a strip of height 2 half.y
  Vector along{1.0, 0.0};  ///< the direction of x, of any length: (cos θ, sin θ) of a bond with ψ6 = exp(6 i θ)
};

/// Returns the pair correlation of the plane, which shows positional order along the rows of a crystal.
///
///     g(x, y) = ordered pairs with a separation in the rectangle / (N (N − 1) · its area / area of the box)
///     C(x, y) = mean of Re ψ_i* ψ_j over these pairs
///
/// 1 for an ideal gas; g(−x, −y) = g(x, y). Errors: those of find_pair_correlations(), whose range is here the distance
/// of the corners, |half|; Error for a direction of no length and for a grid without area. The result does not depend
/// on `threads`. Cost: 10 ns a pair nearer than the corners. Source: E. P. Bernard & W. Krauth (2011),
/// doi:10.1103/PhysRevLett.107.155704.
PairCorrelationMap find_pair_correlation_map(Box const& box, PointsInMemory const& points, MapGrid const& grid,
                                             std::span<std::complex<double> const> orders = {},
                                             std::uint64_t threads = 1);

}  // namespace gridlock
