#include "analysis/pair_histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/avx512.hpp"
#include "grid/require.hpp"
#include "gridlock/core/detail/thread_pool.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/oblique_points.hpp"
#include "observe/pair_products.hpp"

namespace gridlock {

namespace {

constexpr std::size_t batch = 8;
constexpr std::size_t max_bins_of_pairs = 10'000'000;  ///< limit of the bins of all pairs of kinds together

/// Binning of the distances from a point; the box where distances are those of nearest images, else nullptr.
struct Binning {
  PairBins const* bins;
  Box const* box;

  [[nodiscard]] Vector separation(Vector from, Vector to) const {
    return box != nullptr ? box->displacement_inside(from, to) : to - from;
  }
};

/// Finds the rings of the distances from p to up to eight points.
void find_rings_scalar(Binning const& binning, Vector p, double const* x, double const* y, std::size_t count,
                       std::int32_t* found) {
  auto const outside = static_cast<double>(binning.bins->count);
  for (std::size_t k = 0; k < count; ++k) {
    double const distance = std::sqrt(squared_length(binning.separation(p, {x[k], y[k]})));
    found[k] = static_cast<std::int32_t>(std::min(distance * binning.bins->rings_per_length, outside));
  }
}

/// Finds the rectangles of the separations from p to up to eight points.
void find_rectangles(Binning const& binning, Vector p, double const* x, double const* y, std::size_t count,
                     std::int32_t* found) {
  PairBins const& bins = *binning.bins;
  auto const columns = static_cast<std::int32_t>(bins.columns);
  auto const all = static_cast<std::int32_t>(bins.count);
  for (std::size_t k = 0; k < count; ++k) {
    Vector const d = binning.separation(p, {x[k], y[k]});
    double const right = dot(bins.along, d) + bins.half.x;
    double const up = bins.along.x * d.y - bins.along.y * d.x + bins.half.y;
    bool const is_inside = right >= 0.0 && right < 2.0 * bins.half.x && up >= 0.0 && up < 2.0 * bins.half.y;
    found[k] = all;
    if (!is_inside) continue;
    auto const column = static_cast<std::int32_t>(right * bins.bins_per_length.x);
    auto const row = static_cast<std::int32_t>(up * bins.bins_per_length.y);
    found[k] = std::min(row * columns + std::min(column, columns - 1), all - 1);
  }
}

/// The orders ψ of points, row by row.
struct OrdersOfRows {
  std::vector<double> real, imaginary;
  double units;  ///< number of units in 1 of a product of orders, a power of two
};

/// Finds the whole numbers next to Re ψ* ψ_k · units of up to eight points.
void find_products_scalar(std::complex<double> order, double units, double const* real, double const* imaginary,
                          std::size_t count, std::int64_t* products) {
  for (std::size_t k = 0; k < count; ++k) products[k] = product_in_units(order, {real[k], imaginary[k]}, units);
}

#ifdef GRIDLOCK_AVX512
GRIDLOCK_AVX512 void find_rings_avx512(Binning const& binning, Vector p, double const* x, double const* y,
                                       std::size_t count, std::int32_t* found) {
  auto const lanes = static_cast<__mmask8>((1U << count) - 1U);
  __m512d dx = _mm512_sub_pd(_mm512_maskz_loadu_pd(lanes, x), _mm512_set1_pd(p.x));
  __m512d dy = _mm512_sub_pd(_mm512_maskz_loadu_pd(lanes, y), _mm512_set1_pd(p.y));
  if (binning.box != nullptr) {
    dx = nearest_image(dx, binning.box->width());
    if (binning.box->is_periodic_y()) dy = nearest_image(dy, binning.box->height());
  }
  __m512d const square = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy));
  __m512d const scaled = _mm512_mul_pd(_mm512_sqrt_pd(square), _mm512_set1_pd(binning.bins->rings_per_length));
  __m512d const outside = _mm512_set1_pd(static_cast<double>(binning.bins->count));
  __m256i const rings = _mm512_cvttpd_epi32(_mm512_min_pd(scaled, outside));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(found), rings);
}

GRIDLOCK_AVX512 void find_products_avx512(std::complex<double> order, double units, double const* real,
                                          double const* imaginary, std::size_t count, std::int64_t* products) {
  auto const lanes = static_cast<__mmask8>((1U << count) - 1U);
  __m512d const first = _mm512_mul_pd(_mm512_set1_pd(units * order.real()), _mm512_maskz_loadu_pd(lanes, real));
  __m512d const second = _mm512_mul_pd(_mm512_set1_pd(units * order.imag()), _mm512_maskz_loadu_pd(lanes, imaginary));
  __m512d const shift = _mm512_set1_pd(whole_number_shift);
  __m512d const shifted = _mm512_add_pd(_mm512_add_pd(first, second), shift);
  _mm512_storeu_si512(products, _mm512_sub_epi64(_mm512_castpd_si512(shifted), _mm512_castpd_si512(shift)));
}
#endif

auto* fastest_find_bins(PairBins const& bins) {
  if (bins.columns > 0) return &find_rectangles;
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return &find_rings_avx512;
#endif
  return &find_rings_scalar;
}

auto* fastest_find_products() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return &find_products_avx512;
#endif
  return &find_products_scalar;
}

/// A sum over the pairs of a bin, without orders and with them.
struct PairCount {
  static constexpr bool has_orders = false;
  std::uint64_t pairs = 0;
  void add(PairCount const& other) { pairs += other.pairs; }
};
struct PairCountWithOrders {
  static constexpr bool has_orders = true;
  std::uint64_t pairs = 0;
  std::int64_t products = 0;
  void add(PairCountWithOrders const& other) {
    pairs += other.pairs;
    products += other.products;
  }
};

/// Sums over pairs of every two kinds in bins; one further bin is that of pairs out of the range.
template <class Sum>
class PairHistogram {
 public:
  PairHistogram(Box const& box, CellList const& points, std::vector<std::uint32_t> const& kind_of_row,
                OrdersOfRows const& orders, std::size_t kinds, PairBins const& bins)
      : box_(box),
        points_(points),
        kind_of_row_(kind_of_row),
        orders_(orders),
        kinds_(kinds),
        bins_(bins),
        find_bins_(fastest_find_bins(bins)) {}

  /// Returns the sums over all pairs whose first point is in rows of cells `first` … `end` − 1.
  [[nodiscard]] std::vector<Sum> sums(int first, int end) const {
    CellLayout const& layout = points_.layout();
    auto const blocks = points_.blocks();
    std::vector<Sum> found(kinds_ * kinds_ * stride());
    for (int row = first; row < end; ++row) {
      for (int column = 0; column < layout.columns(); ++column) {
        auto const cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(layout.columns()) +
                          static_cast<std::size_t>(column);
        add_cell(cell, blocks.has_halves() ? blocks.after(column, row) : blocks.around(column, row),
                 blocks.has_halves(), found);
      }
    }
    return found;
  }

 private:
  [[nodiscard]] std::size_t stride() const { return bins_.count + 1; }

  void add_cell(std::size_t cell, RowBlock block, bool is_half, std::vector<Sum>& sums) const {
    Binning const binning{.bins = &bins_, .box = block.is_at_edge ? &box_ : nullptr};
    for (std::size_t row = points_.first_of(cell); row < points_.first_of(cell + 1); ++row) {
      // The point's own cell is first in the block: its pairs are counted at the row that comes first.
      if (is_half) block.rows[0].first = row + 1;
      Sum* const from = sums.data() + kind_of_row_[row] * kinds_ * stride();
      for (RowRange range : block.ranges()) {
        if (!is_half) range.first = std::max(range.first, row + 1);
        if (range.first < range.end) add_range(binning, row, range, from);
      }
    }
  }

  void add_range(Binning const& binning, std::size_t row, RowRange range, Sum* sums) const {
    Vector const p{points_.x()[row], points_.y()[row]};
    std::array<std::int32_t, batch> bins;
    [[maybe_unused]] std::array<std::int64_t, batch> products;
    for (std::size_t k = range.first; k < range.end; k += batch) {
      std::size_t const count = std::min(batch, range.end - k);
      find_bins_(binning, p, points_.x() + k, points_.y() + k, count, bins.data());
      if constexpr (Sum::has_orders) {
        find_products_({orders_.real[row], orders_.imaginary[row]}, orders_.units, orders_.real.data() + k,
                       orders_.imaginary.data() + k, count, products.data());
      }
      for (std::size_t l = 0; l < count; ++l) {
        Sum& sum = sums[kind_of_row_[k + l] * stride() + static_cast<std::size_t>(bins[l])];
        ++sum.pairs;
        if constexpr (Sum::has_orders) sum.products += products[l];
      }
    }
  }

  Box const& box_;
  CellList const& points_;
  std::vector<std::uint32_t> const& kind_of_row_;
  OrdersOfRows const& orders_;
  std::size_t kinds_;
  PairBins const& bins_;
  decltype(&find_rings_scalar) find_bins_;
  decltype(&find_products_scalar) find_products_ = fastest_find_products();
};

/// Returns the largest |ψ|².
double largest_square(std::span<std::complex<double> const> orders) {
  double largest = 0.0;
  for (std::complex<double> const order : orders) {
    largest = std::max(largest, order.real() * order.real() + order.imag() * order.imag());
  }
  return largest;
}

PairSums finished(std::vector<PairCount> const& sums, std::vector<double> sizes, double /*units*/) {
  PairSums result{.pairs = {}, .orders = {}, .sizes = std::move(sizes)};
  for (PairCount const& sum : sums) result.pairs.push_back(sum.pairs);
  return result;
}

PairSums finished(std::vector<PairCountWithOrders> const& sums, std::vector<double> sizes, double units) {
  PairSums result{.pairs = {}, .orders = {}, .sizes = std::move(sizes)};
  for (PairCountWithOrders const& sum : sums) {
    result.pairs.push_back(sum.pairs);
    result.orders.push_back(static_cast<double>(sum.products) / units);
  }
  return result;
}

template <class Sum>
PairSums sum_in_rectangle(Box const& box, PointsInMemory const& points, PairBins const& bins,
                          std::span<std::uint32_t const> kinds, std::span<std::complex<double> const> orders,
                          std::uint64_t threads) {
  ThreadPool pool(threads);
  CellList const sorted(layout_for_cutoff(box, bins.range, points.count), {}, points, pool);
  std::vector<double> sizes(kinds.empty() ? 1 : std::ranges::max(kinds) + std::size_t{1}, 0.0);
  std::vector<std::uint32_t> kind_of_row(points.count, 0);
  OrdersOfRows of_rows{.real = {}, .imaginary = {}, .units = units_of_products(largest_square(orders), points.count)};
  for (std::size_t row = 0; row < points.count; ++row) {
    std::uint32_t const point = sorted.index(row);
    if (!kinds.empty()) kind_of_row[row] = kinds[point];
    sizes[kind_of_row[row]] += 1.0;
    if constexpr (Sum::has_orders) {
      of_rows.real.push_back(orders[point].real());
      of_rows.imaginary.push_back(orders[point].imag());
    }
  }
  PairHistogram<Sum> const histogram(box, sorted, kind_of_row, of_rows, sizes.size(), bins);
  std::vector<int> const ends = bands_of(sorted, pool);
  std::vector<std::vector<Sum>> of_bands(ends.size() - 1);
  pool.for_each(of_bands.size(), [&](std::size_t b) { of_bands[b] = histogram.sums(ends[b], ends[b + 1]); });
  std::vector<Sum> sums(sizes.size() * sizes.size() * (bins.count + 1));
  for (std::vector<Sum> const& band : of_bands) {
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k].add(band[k]);
  }
  return finished(sums, std::move(sizes), of_rows.units);
}

PairSums sum_over_rectangle(Box const& box, PointsInMemory const& points, PairBins const& bins,
                            std::span<std::uint32_t const> kinds, std::span<std::complex<double> const> orders,
                            std::uint64_t threads) {
  return orders.empty() ? sum_in_rectangle<PairCount>(box, points, bins, kinds, orders, threads)
                        : sum_in_rectangle<PairCountWithOrders>(box, points, bins, kinds, orders, threads);
}

/// Sums over pairs in an oblique box. The images of each kind count as a kind of their own, whose pairs with points,
/// and not with images, are pairs of the box.
PairSums sum_over_oblique(Box const& box, PointsInMemory const& points, PairBins const& bins,
                          std::span<std::uint32_t const> kinds, std::span<std::complex<double> const> orders,
                          std::uint64_t threads) {
  ObliquePoints const all(box, bins.range, points.x, points.y, points.count, points.stride,
                          ObliquePoints::Images::above);
  std::size_t const count = kinds.empty() ? 1 : std::ranges::max(kinds) + std::size_t{1};
  std::vector<std::uint32_t> kinds_of_all(all.size());
  std::vector<std::complex<double>> orders_of_all(orders.empty() ? 0 : all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    std::uint32_t const kind = kinds.empty() ? 0 : kinds[all.point(k)];
    kinds_of_all[k] = kind + static_cast<std::uint32_t>(k < all.own() ? 0 : count);
    if (!orders.empty()) orders_of_all[k] = orders[all.point(k)];
  }
  PointsInMemory const in_frame{.x = all.x().data(), .y = all.y().data(), .count = all.size()};
  PairSums const found = sum_over_rectangle(all.frame(), in_frame, bins, kinds_of_all, orders_of_all, threads);
  std::size_t const stride = bins.count + 1;
  PairSums sums{.pairs = std::vector<std::uint64_t>(count * count * stride),
                .orders = std::vector<double>(orders.empty() ? 0 : count * count * stride),
                .sizes = {found.sizes.begin(), found.sizes.begin() + static_cast<std::ptrdiff_t>(count)}};
  for (std::size_t a = 0; a < found.kinds(); ++a) {
    for (std::size_t b = 0; b < found.kinds(); ++b) {
      if (a >= count && b >= count) continue;
      std::size_t const from = (a * found.kinds() + b) * stride;
      std::size_t const to = ((a % count) * count + b % count) * stride;
      for (std::size_t k = 0; k < stride; ++k) {
        sums.pairs[to + k] += found.pairs[from + k];
        if (!orders.empty()) sums.orders[to + k] += found.orders[from + k];
      }
    }
  }
  return sums;
}

void require_labels(PointsInMemory const& points, std::span<std::uint32_t const> kinds,
                    std::span<std::complex<double> const> orders) {
  if (!kinds.empty() && kinds.size() != points.count) {
    throw Error({.what = fmt::format("there are kinds of {} points, but {} points", kinds.size(), points.count),
                 .hint = "give one kind for each point"});
  }
  if (!orders.empty() && orders.size() != points.count) {
    throw Error({.what = fmt::format("there are orders of {} points, but {} points", orders.size(), points.count),
                 .hint = "give one complex number for each point"});
  }
  for (std::size_t i = 0; i < orders.size(); ++i) {
    if (std::isfinite(orders[i].real()) && std::isfinite(orders[i].imag())) continue;
    throw Error({.what = fmt::format("the order of point {} is ({}, {})", i, orders[i].real(), orders[i].imag()),
                 .hint = "use finite numbers"});
  }
}

}  // namespace

PairSums sum_over_pairs(Box const& box, PointsInMemory const& points, PairBins const& bins,
                        std::span<std::uint32_t const> kinds, std::span<std::complex<double> const> orders,
                        std::uint64_t threads) {
  if (!box.is_periodic()) {
    throw Error(Problem{.what = "the pair correlation needs a box that is periodic in x and y",
                        .hint = "give a box with periodic edges; a run measures it between walls too, with "
                                "observables.pair_correlation"});
  }
  require_search(points, bins.range);
  require_box_for(box, bins.range);
  require_labels(points, kinds, orders);
  std::size_t const count = kinds.empty() ? 1 : std::size_t{1} + std::ranges::max(kinds);
  if (bins.count < 1 || count > max_bins_of_pairs || bins.count > max_bins_of_pairs / (count * count)) {
    throw Error({.what = fmt::format("a pair correlation of {} kinds in {} bins", count, bins.count),
                 .hint = fmt::format("use at least one bin, and at most {} of all pairs of kinds together: radii that "
                                     "are nearly equal can be one kind",
                                     max_bins_of_pairs)});
  }
  return box.is_oblique() ? sum_over_oblique(box, points, bins, kinds, orders, threads)
                          : sum_over_rectangle(box, points, bins, kinds, orders, threads);
}

}  // namespace gridlock
