#include "gridlock/analysis/pair_correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "analysis/count_pairs.hpp"
#include "core/avx512.hpp"
#include "grid/require.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/oblique_points.hpp"

namespace gridlock {

namespace {

constexpr std::size_t batch = 8;
constexpr std::size_t max_bins = 10'000'000;  ///< limit of the bins of all pairs of kinds together

/// The conversion of distances to bins; bin number `bins` counts distances out of the range.
struct Binning {
  double bins_per_length;
  double bins;
  Box const* box;  ///< the box where distances are those of nearest images, else nullptr
};

/// Finds the bins of the distances from p to up to eight points.
void find_bins_scalar(Binning const& binning, Vector p, double const* x, double const* y, std::size_t count,
                      std::int32_t* bins) {
  for (std::size_t k = 0; k < count; ++k) {
    Vector const d =
        binning.box != nullptr ? binning.box->displacement_inside(p, {x[k], y[k]}) : Vector{x[k], y[k]} - p;
    bins[k] =
        static_cast<std::int32_t>(std::min(std::sqrt(d.x * d.x + d.y * d.y) * binning.bins_per_length, binning.bins));
  }
}

#ifdef GRIDLOCK_AVX512
GRIDLOCK_AVX512 void find_bins_avx512(Binning const& binning, Vector p, double const* x, double const* y,
                                      std::size_t count, std::int32_t* bins) {
  auto const lanes = static_cast<__mmask8>((1U << count) - 1U);
  __m512d dx = _mm512_sub_pd(_mm512_maskz_loadu_pd(lanes, x), _mm512_set1_pd(p.x));
  __m512d dy = _mm512_sub_pd(_mm512_maskz_loadu_pd(lanes, y), _mm512_set1_pd(p.y));
  if (binning.box != nullptr) {
    dx = nearest_image(dx, binning.box->width());
    if (binning.box->is_periodic_y()) dy = nearest_image(dy, binning.box->height());
  }
  __m512d const square = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy));
  __m512d const scaled = _mm512_mul_pd(_mm512_sqrt_pd(square), _mm512_set1_pd(binning.bins_per_length));
  __m256i const found = _mm512_cvttpd_epi32(_mm512_min_pd(scaled, _mm512_set1_pd(binning.bins)));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(bins), found);
}
#endif

auto* fastest_find_bins() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return &find_bins_avx512;
#endif
  return &find_bins_scalar;
}

/// Numbers of pairs of every two kinds in bins; one further bin counts pairs out of the range.
class Histogram {
 public:
  Histogram(Box const& box, CellList const& points, std::vector<std::uint32_t> const& kind_of_row, std::size_t kinds,
            double range, std::size_t bins)
      : box_(box),
        points_(points),
        kind_of_row_(kind_of_row),
        kinds_(kinds),
        stride_(bins + 1),
        bins_per_length_(static_cast<double>(bins) / range) {}

  /// Counts all pairs whose first point is in rows of cells `first` … `end` − 1.
  [[nodiscard]] std::vector<std::uint64_t> count(int first, int end) const {
    CellLayout const& layout = points_.layout();
    auto const blocks = points_.blocks();
    std::vector<std::uint64_t> counts(kinds_ * kinds_ * stride_, 0);
    for (int row = first; row < end; ++row) {
      for (int column = 0; column < layout.columns(); ++column) {
        auto const cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns()) +
                          static_cast<std::size_t>(column);
        count_cell(cell, blocks.has_halves() ? blocks.after(column, row) : blocks.around(column, row),
                   blocks.has_halves(), counts);
      }
    }
    return counts;
  }

 private:
  void count_cell(std::size_t cell, RowBlock block, bool is_half, std::vector<std::uint64_t>& counts) const {
    Binning const binning{.bins_per_length = bins_per_length_,
                          .bins = static_cast<double>(stride_ - 1),
                          .box = block.is_at_edge ? &box_ : nullptr};
    for (std::size_t row = points_.first_of(cell); row < points_.first_of(cell + 1); ++row) {
      // The point's own cell is first in the block: its pairs are counted at the row that comes first.
      if (is_half) block.rows[0].first = row + 1;
      std::uint64_t* const from = counts.data() + kind_of_row_[row] * kinds_ * stride_;
      for (RowRange range : block.ranges()) {
        if (!is_half) range.first = std::max(range.first, row + 1);
        if (range.first < range.end) count_range(binning, row, range, from);
      }
    }
  }

  void count_range(Binning const& binning, std::size_t row, RowRange range, std::uint64_t* counts) const {
    Vector const p{points_.x()[row], points_.y()[row]};
    std::array<std::int32_t, batch> bins;
    for (std::size_t k = range.first; k < range.end; k += batch) {
      std::size_t const count = std::min(batch, range.end - k);
      find_bins_(binning, p, points_.x() + k, points_.y() + k, count, bins.data());
      for (std::size_t l = 0; l < count; ++l) {
        ++counts[kind_of_row_[k + l] * stride_ + static_cast<std::size_t>(bins[l])];
      }
    }
  }

  Box const& box_;
  CellList const& points_;
  std::vector<std::uint32_t> const& kind_of_row_;
  std::size_t kinds_;
  std::size_t stride_;
  double bins_per_length_;
  decltype(fastest_find_bins()) find_bins_ = fastest_find_bins();
};

/// Returns g(r) from counts of pairs, each counted once.
PairCorrelations normalized(Box const& box, double range, std::size_t bins, CountedPairs const& counted) {
  std::vector<double> const& points = counted.sizes;
  PairCorrelations result{.kinds = points.size(), .distance = {}, .g = {}};
  double const width = range / static_cast<double>(bins);
  for (std::size_t k = 0; k < bins; ++k) result.distance.push_back((static_cast<double>(k) + 0.5) * width);
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = 0; b < points.size(); ++b) {
      double const pairs = a == b ? 0.5 * points[a] * (points[a] - 1.0) : points[a] * points[b];
      for (std::size_t k = 0; k < bins; ++k) {
        std::uint64_t const seen = counted.of(a, b, k);
        double const ring = 2.0 * std::numbers::pi * width * result.distance[k];
        result.g.push_back(static_cast<double>(seen) / (pairs * ring / box.area()));
      }
    }
  }
  return result;
}

CountedPairs count_pairs_of_rectangle(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                      std::span<std::uint32_t const> kinds, std::uint64_t threads) {
  ThreadPool pool(threads);
  CellList const sorted(layout_for_cutoff(box, range, points.count), {}, points, pool);
  std::vector<double> sizes(kinds.empty() ? 1 : std::ranges::max(kinds) + 1, 0.0);
  std::vector<std::uint32_t> kind_of_row(points.count, 0);
  for (std::size_t row = 0; row < points.count; ++row) {
    if (!kinds.empty()) kind_of_row[row] = kinds[sorted.index(row)];
    sizes[kind_of_row[row]] += 1.0;
  }
  Histogram const histogram(box, sorted, kind_of_row, sizes.size(), range, bins);
  std::vector<int> const ends = bands_of(sorted, pool);
  std::vector<std::vector<std::uint64_t>> counts(ends.size() - 1);
  pool.for_each(counts.size(), [&](std::size_t b) { counts[b] = histogram.count(ends[b], ends[b + 1]); });
  std::vector<std::uint64_t> sum(sizes.size() * sizes.size() * (bins + 1), 0);
  for (std::vector<std::uint64_t> const& band : counts) {
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += band[k];
  }
  return {std::move(sum), std::move(sizes)};
}

/// Counts pairs in an oblique box. The images of each kind count as a kind of their own, whose pairs with points, and
/// not with images, are pairs of the box.
CountedPairs count_pairs_of_oblique(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                    std::span<std::uint32_t const> kinds, std::uint64_t threads) {
  ObliquePoints const all(box, range, points.x, points.y, points.count, points.stride, ObliquePoints::Images::above);
  std::size_t const count = kinds.empty() ? 1 : std::ranges::max(kinds) + std::size_t{1};
  std::vector<std::uint32_t> kinds_of_all(all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::uint32_t const kind = kinds.empty() ? 0 : kinds[all.point(k)];
    kinds_of_all[k] = kind + static_cast<std::uint32_t>(k < all.own() ? 0 : count);
  }
  PointsInMemory const in_frame{.x = all.x().data(), .y = all.y().data(), .count = all.size()};
  CountedPairs const found = count_pairs_of_rectangle(all.frame(), in_frame, range, bins, kinds_of_all, threads);
  std::size_t const all_kinds = found.sizes.size();
  CountedPairs counted{.pairs = std::vector<std::uint64_t>(count * count * (bins + 1)),
                       .sizes = {found.sizes.begin(), found.sizes.begin() + static_cast<std::ptrdiff_t>(count)}};
  for (std::size_t a = 0; a < all_kinds; ++a) {
    for (std::size_t b = 0; b < all_kinds; ++b) {
      if (a >= count && b >= count) continue;
      std::size_t const to = (a % count) * count + b % count;
      for (std::size_t k = 0; k <= bins; ++k) {
        counted.pairs[to * (bins + 1) + k] += found.pairs[(a * all_kinds + b) * (bins + 1) + k];
      }
    }
  }
  return counted;
}

}  // namespace

void require_pair_correlation(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                              std::span<std::uint32_t const> kinds) {
  if (!box.is_periodic()) {
    throw Error(Problem{.what = "the pair correlation needs a box that is periodic in x and y",
                        .hint = "give a box with periodic edges; a run measures it between walls too, with "
                                "observables.pair_correlation"});
  }
  require_search(points, range);
  require_box_for(box, range);
  if (!kinds.empty() && kinds.size() != points.count) {
    throw Error({.what = fmt::format("there are kinds of {} points, but {} points", kinds.size(), points.count),
                 .hint = "give one kind for each point"});
  }
  std::size_t const count = kinds.empty() ? 1 : std::size_t{1} + std::ranges::max(kinds);
  if (bins >= 1 && count <= max_bins && bins <= max_bins / (count * count)) return;
  throw Error(
      {.what = fmt::format("a pair correlation of {} kinds in {} bins", count, bins),
       .hint = fmt::format("use at least one bin, and at most {} of all pairs of kinds together: radii that are nearly "
                           "equal can be one kind",
                           max_bins)});
}

CountedPairs count_pairs(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                         std::span<std::uint32_t const> kinds, std::uint64_t threads) {
  return box.is_oblique() ? count_pairs_of_oblique(box, points, range, bins, kinds, threads)
                          : count_pairs_of_rectangle(box, points, range, bins, kinds, threads);
}

PairCorrelations find_pair_correlations(Box const& box, PointsInMemory const& points, double range, std::size_t bins,
                                        std::span<std::uint32_t const> kinds, std::uint64_t threads) {
  require_pair_correlation(box, points, range, bins, kinds);
  CountedPairs const counted = count_pairs(box, points, range, bins, kinds, threads);
  return normalized(box, range, bins, counted);
}

}  // namespace gridlock
