#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// The conversion of separations to bins: rings of equal width, or the rectangles of a grid in a turned frame.
struct PairBins {
  std::size_t count = 1;  ///< number of bins; bin number `count` is that of pairs out of the range
  double range = 0.0;     ///< the largest distance
  double rings_per_length = 0.0;
  // A grid has these, too.
  std::size_t columns = 0;  ///< 0 for rings
  Vector along{1.0, 0.0};   ///< the direction of the rows, a unit vector
  Vector half{};            ///< half the width and half the height of the grid
  Vector bins_per_length{};

  static PairBins rings(double range, std::size_t bins) {
    return {.count = bins, .range = range, .rings_per_length = static_cast<double>(bins) / range};
  }
  static PairBins grid(Vector half, std::size_t columns, std::size_t rows, Vector along) {
    return {.count = columns * rows,
            .range = std::sqrt(squared_length(half)),
            .columns = columns,
            .along = along,
            .half = half,
            .bins_per_length = {0.5 * static_cast<double>(columns) / half.x, 0.5 * static_cast<double>(rows) / half.y}};
  }
};

/// Sums over the pairs of every two kinds a and b: those of bin k are at ((a · kinds) + b) · (bins + 1) + k, and each
/// pair is at (a, b) or (b, a).
struct PairSums {
  std::vector<std::uint64_t> pairs;
  std::vector<double> orders;  ///< Σ Re ψ_i* ψ_j; empty without orders
  std::vector<double> sizes;   ///< number of points of each kind

  [[nodiscard]] std::size_t kinds() const { return sizes.size(); }
  /// Returns the number of pairs of kinds a and b in a bin.
  [[nodiscard]] std::uint64_t between(std::size_t a, std::size_t b, std::size_t bin) const {
    std::size_t const stride = pairs.size() / (kinds() * kinds());
    std::uint64_t const one = pairs[(a * kinds() + b) * stride + bin];
    return a == b ? one : one + pairs[(b * kinds() + a) * stride + bin];
  }
};

/// Returns sums over all pairs in the range, of points with a kind each (empty: one kind) and an order ψ each (empty:
/// none). Products of orders are added as whole numbers, in units of at most N² · 2⁻⁵⁹ of the largest |ψ|², so that the
/// sums do not depend on the order of the pairs. Errors: those of require_search() and require_box_for(); Error for
/// kinds or orders of another length than the points, and for orders that are not finite.
PairSums sum_over_pairs(Box const& box, PointsInMemory const& points, PairBins const& bins,
                        std::span<std::uint32_t const> kinds, std::span<std::complex<double> const> orders,
                        std::uint64_t threads);

}  // namespace gridlock
