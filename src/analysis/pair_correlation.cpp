#include "gridlock/analysis/pair_correlation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "analysis/pair_histogram.hpp"

namespace gridlock {

namespace {

constexpr std::size_t max_map_side = 10'000'000;

double mean_order(double sum, std::uint64_t pairs) {
  return pairs == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(pairs);
}

/// Returns g(r) from sums over pairs, each counted once.
PairCorrelations normalized(Box const& box, double range, std::size_t bins, PairSums const& sums) {
  PairCorrelations result{.kinds = sums.kinds(), .distance = {}, .g = {}, .order_correlation = {}};
  double const width = range / static_cast<double>(bins);
  for (std::size_t k = 0; k < bins; ++k) result.distance.push_back((static_cast<double>(k) + 0.5) * width);
  for (std::size_t a = 0; a < sums.kinds(); ++a) {
    for (std::size_t b = 0; b < sums.kinds(); ++b) {
      double const pairs = a == b ? 0.5 * sums.sizes[a] * (sums.sizes[a] - 1.0) : sums.sizes[a] * sums.sizes[b];
      for (std::size_t k = 0; k < bins; ++k) {
        std::size_t const here = (a * sums.kinds() + b) * (bins + 1) + k;
        std::size_t const there = (b * sums.kinds() + a) * (bins + 1) + k;
        std::uint64_t const seen = sums.between(a, b, k);
        double const ring = 2.0 * std::numbers::pi * width * result.distance[k];
        result.g.push_back(static_cast<double>(seen) / (pairs * ring / box.area()));
        if (sums.orders.empty()) continue;
        result.order_correlation.push_back(mean_order(sums.orders[here] + (a == b ? 0.0 : sums.orders[there]), seen));
      }
    }
  }
  return result;
}

PairBins bins_of(MapGrid const& grid) {
  double const length = std::sqrt(squared_length(grid.along));
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw Error({.what = fmt::format("the direction of a map is ({}, {})", grid.along.x, grid.along.y),
                 .hint = "use a vector that is not zero"});
  }
  if (!(grid.half.x > 0.0 && grid.half.y > 0.0) || grid.columns == 0 || grid.rows == 0 || grid.columns > max_map_side ||
      grid.rows > max_map_side) {
    throw Error({.what = fmt::format("a map has {} × {} rectangles in ±{} × ±{}", grid.columns, grid.rows, grid.half.x,
                                     grid.half.y),
                 .hint = fmt::format("use 1 to {} columns and rows, and lengths above 0", max_map_side)});
  }
  return PairBins::grid(grid.half, grid.columns, grid.rows, (1.0 / length) * grid.along);
}

/// Returns the middles of `bins` bins from −half to half.
std::vector<double> middles(double half, std::size_t bins) {
  std::vector<double> found;
  for (std::size_t k = 0; k < bins; ++k) {
    found.push_back(half * ((2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(bins) - 1.0));
  }
  return found;
}

}  // namespace

PairCorrelations find_pair_correlations(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                        std::span<std::uint32_t const> kinds, std::uint64_t threads,
                                        std::span<std::complex<double> const> orders) {
  PairSums const sums = sum_over_pairs(box, points, PairBins::rings(range, bins), kinds, orders, threads);
  return normalized(box, range, bins, sums);
}

PairCorrelationMap find_pair_correlation_map(Box const& box, PointsInMemory const& points, MapGrid const& grid,
                                             std::span<std::complex<double> const> orders, std::uint64_t threads) {
  PairSums const sums = sum_over_pairs(box, points, bins_of(grid), {}, orders, threads);
  PairCorrelationMap map{
      .x = middles(grid.half.x, grid.columns), .y = middles(grid.half.y, grid.rows), .g = {}, .order_correlation = {}};
  std::size_t const bins = grid.columns * grid.rows;
  double const rectangle = 4.0 * grid.half.x * grid.half.y / static_cast<double>(bins);
  double const expected = sums.sizes[0] * (sums.sizes[0] - 1.0) * rectangle / box.area();
  for (std::size_t k = 0; k < bins; ++k) {
    // Each pair was seen from one of its points; from the other it has the opposite separation.
    std::size_t const opposite = bins - 1 - k;
    std::uint64_t const seen = sums.pairs[k] + sums.pairs[opposite];
    map.g.push_back(static_cast<double>(seen) / expected);
    if (!orders.empty()) map.order_correlation.push_back(mean_order(sums.orders[k] + sums.orders[opposite], seen));
  }
  return map;
}

}  // namespace gridlock
