#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/box.hpp"
#include "gridlock/grid/neighbour_lists.hpp"

namespace gridlock {

/// Pairs of every two kinds in bins, each counted once, and the number of points of each kind. Pairs of a point of kind
/// a and one of kind b in bin k are at ((a · kinds) + b) · (bins + 1) + k and with a and b exchanged; bin `bins` counts
/// pairs out of the range.
struct CountedPairs {
  std::vector<std::uint64_t> pairs;
  std::vector<double> sizes;

  /// Returns the number of pairs of kinds a and b in a bin.
  [[nodiscard]] std::uint64_t of(std::size_t a, std::size_t b, std::size_t bin) const {
    std::size_t const stride = pairs.size() / (sizes.size() * sizes.size());
    std::uint64_t const one = pairs[(a * sizes.size() + b) * stride + bin];
    return a == b ? one : one + pairs[(b * sizes.size() + a) * stride + bin];
  }
};

/// Counts pairs in bins of distances up to `range`. Contract: the arguments are those that find_pair_correlations()
/// accepts.
CountedPairs count_pairs(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                         std::span<std::uint32_t const> kinds, std::uint64_t threads);

/// Errors: those of find_pair_correlations().
void require_pair_correlation(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                              std::span<std::uint32_t const> kinds);

}  // namespace gridlock
