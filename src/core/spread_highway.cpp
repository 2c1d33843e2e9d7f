#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/decay.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/spread.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself;
// target() chooses the kernel. SVE is left out, as everywhere, and so are targets that target() does not name.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/spread_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GRIDLOCK_WEIGHTED_SUM
#define GRIDLOCK_WEIGHTED_SUM
namespace gridlock {

/// Returns Σ weights[n] (rows[-n][k] + rows[n][k]), the term n = 0 counted once. `rows` points to the middle of
/// 2 · weights.size() − 1 pointers.
inline double weighted_sum(double const* const* rows, std::span<double const> weights, std::size_t k) {
  double sum = weights[0] * rows[0][k];
  for (std::ptrdiff_t n = 1; n < static_cast<std::ptrdiff_t>(weights.size()); ++n) {
    sum = sum + weights[static_cast<std::size_t>(n)] * (rows[-n][k] + rows[n][k]);
  }
  return sum;
}

}  // namespace gridlock
#endif

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Carries out add_weighted_plain().
void add_weighted(double const* const* rows, std::span<double const> weights, double* out, std::size_t first,
                  std::size_t last) {
  hn::ScalableTag<double> const tag;
  std::size_t const lanes = hn::Lanes(tag);
  auto const reach = static_cast<std::ptrdiff_t>(weights.size());
  std::size_t k = first;
  // Four registers at a time hide the delay of an addition.
  for (; k + 4 * lanes <= last; k += 4 * lanes) {
    auto const middle = hn::Set(tag, weights[0]);
    auto a = hn::Mul(middle, hn::LoadU(tag, rows[0] + k));
    auto b = hn::Mul(middle, hn::LoadU(tag, rows[0] + k + lanes));
    auto c = hn::Mul(middle, hn::LoadU(tag, rows[0] + k + 2 * lanes));
    auto d = hn::Mul(middle, hn::LoadU(tag, rows[0] + k + 3 * lanes));
    for (std::ptrdiff_t n = 1; n < reach; ++n) {
      auto const weight = hn::Set(tag, weights[static_cast<std::size_t>(n)]);
      double const* const low = rows[-n] + k;
      double const* const high = rows[n] + k;
      auto const both = [&](std::size_t by) { return hn::Add(hn::LoadU(tag, low + by), hn::LoadU(tag, high + by)); };
      a = hn::Add(a, hn::Mul(weight, both(0)));
      b = hn::Add(b, hn::Mul(weight, both(lanes)));
      c = hn::Add(c, hn::Mul(weight, both(2 * lanes)));
      d = hn::Add(d, hn::Mul(weight, both(3 * lanes)));
    }
    hn::StoreU(a, tag, out + k);
    hn::StoreU(b, tag, out + k + lanes);
    hn::StoreU(c, tag, out + k + 2 * lanes);
    hn::StoreU(d, tag, out + k + 3 * lanes);
  }
  for (; k < last; ++k) out[k] = weighted_sum(rows, weights, k);
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

namespace {

using AddWeighted = void (*)(double const* const* rows, std::span<double const> weights, double* out, std::size_t first,
                             std::size_t last);

/// Sets out[k] to weighted_sum(rows, weights, k) for k = first … last − 1.
void add_weighted_plain(double const* const* rows, std::span<double const> weights, double* out, std::size_t first,
                        std::size_t last) {
  for (std::size_t k = first; k < last; ++k) out[k] = weighted_sum(rows, weights, k);
}

AddWeighted add_weighted_for([[maybe_unused]] Target instructions) {
#if HWY_TARGETS & HWY_SSE4
  if (instructions == Target::sse4) return N_SSE4::add_weighted;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (instructions == Target::avx2) return N_AVX2::add_weighted;
#endif
#if HWY_TARGETS & HWY_AVX3
  if (instructions == Target::avx512) return N_AVX3::add_weighted;
#endif
#if HWY_TARGETS & HWY_NEON
  if (instructions == Target::neon) return N_NEON::add_weighted;
#endif
  return add_weighted_plain;
}

/// Returns the weights e^(−2λ) Iₙ(2λ) for n = 0, 1 … as far as they matter, scaled so that all of them, those of
/// negative n included, have the sum 1.
std::vector<double> weights_of(double lambda) {
  constexpr double negligible = 1e-17;
  double const z = 2.0 * lambda;
  if (z < negligible) return {1.0};
  auto const last = static_cast<std::size_t>(40.0 + 12.0 * std::sqrt(z));
  // Miller's recurrence from above, which is stable: Iₙ₋₁ = Iₙ₊₁ + (2n/z) Iₙ.
  std::vector<double> weights(last + 2);
  weights[last] = 1e-300;
  for (std::size_t n = last; n > 0; --n) {
    weights[n - 1] = weights[n + 1] + 2.0 * static_cast<double>(n) / z * weights[n];
    if (weights[n - 1] < 1e200) continue;
    for (double& weight : weights) weight *= 1e-300;
  }
  auto const sum_of_all = [&] {
    double sum = 0.0;
    for (std::size_t n = weights.size() - 1; n > 0; --n) sum += weights[n];
    return weights[0] + 2.0 * sum;
  };
  double const least = negligible * sum_of_all();
  while (weights.size() > 1 && !(weights.back() > least)) weights.pop_back();
  double const all = sum_of_all();
  for (double& weight : weights) weight /= all;
  return weights;
}

/// A line of cells, along which values spread.
struct Line {
  std::size_t cells;
  bool is_periodic;

  /// Returns the cell at a place beyond the ends: around the edge, or reflected by the wall.
  [[nodiscard]] std::size_t at(std::ptrdiff_t place) const {
    auto const period = static_cast<std::ptrdiff_t>(is_periodic ? cells : 2 * cells);
    std::ptrdiff_t const inside = (place % period + period) % period;
    auto const cell = static_cast<std::size_t>(inside);
    return cell < cells ? cell : 2 * cells - 1 - cell;
  }
};

/// Returns λ beyond which a line is uniform to the last bit: its slowest wave falls by e^(−λ π² / cells²).
double lambda_of_uniform(Line const& line) {
  return 5.0 * static_cast<double>(line.cells) * static_cast<double>(line.cells);
}

/// Rows that a thread spreads along y at a time, and columns: all that they need stays in the first cache.
constexpr std::size_t rows_of_block = 16;
constexpr std::size_t columns_of_block = 128;

/// Makes the mean of a line of `line.cells` values the value of all.
void make_uniform(Line const& line, double* values, std::size_t stride) {
  double sum = 0.0;
  for (std::size_t k = 0; k < line.cells; ++k) sum += values[k * stride];
  double const mean = sum / static_cast<double>(line.cells);
  for (std::size_t k = 0; k < line.cells; ++k) values[k * stride] = mean;
}

/// Spreads a field along x and along y in one pass over its memory.
///
/// Each band of rows is spread by one thread, block by block from below. A window has the rows around the block, spread
/// along x; so a row of the field may change when the block has passed. The rows at the ends of all bands, which other
/// bands need, are spread along x before, and kept until the end.
class Spread {
 public:
  Spread(Field& field, Box const& box, ThreadPool& threads, Target instructions)
      : values_(field.values()),
        across_{.cells = field.columns(), .is_periodic = box.is_periodic_x()},
        upwards_{.cells = field.rows(), .is_periodic = box.is_periodic_y()},
        threads_(threads),
        add_weighted_(add_weighted_for(instructions)) {}

  void carry_out(double lambda_x, double lambda_y, double factor) {
    if (lambda_x >= lambda_of_uniform(across_)) {
      for (std::size_t row = 0; row < upwards_.cells; ++row) make_uniform(across_, values_of(row), 1);
      lambda_x = 0.0;
    }
    if (lambda_y >= lambda_of_uniform(upwards_)) {
      for (std::size_t column = 0; column < across_.cells; ++column) {
        make_uniform(upwards_, values_.data() + column, across_.cells);
      }
      lambda_y = 0.0;
    }
    weights_x_ = weights_of(lambda_x);
    weights_y_ = weights_of(lambda_y);
    for (double& weight : weights_y_) weight *= factor;
    std::size_t const bands = threads_.size() == 1 ? 1 : std::min(upwards_.cells, 4 * threads_.size());
    choose_rows_to_keep(bands);
    threads_.for_each(bands, [&](std::size_t band) { keep_rows(band_of(band, bands)); });
    threads_.for_each(bands, [&](std::size_t band) { spread_band(band_of(band, bands)); });
  }

 private:
  struct Band {
    std::size_t first;
    std::size_t last;
  };
  /// A row with the values beyond its ends, and the places of the sums along x in it.
  struct PaddedRow {
    std::vector<double> values;
    std::vector<double const*> places;
  };
  static constexpr std::size_t not_kept = static_cast<std::size_t>(-1);
  static std::ptrdiff_t offset(std::size_t count) { return static_cast<std::ptrdiff_t>(count); }

  [[nodiscard]] Band band_of(std::size_t band, std::size_t bands) const {
    return {.first = band * upwards_.cells / bands, .last = (band + 1) * upwards_.cells / bands};
  }
  [[nodiscard]] double* values_of(std::size_t row) { return values_.data() + row * across_.cells; }
  [[nodiscard]] std::size_t reach_x() const { return weights_x_.size() - 1; }
  [[nodiscard]] std::size_t reach_y() const { return weights_y_.size() - 1; }
  /// The distance of rows in memory: an odd number of cache lines, so that rows do not evict each other.
  [[nodiscard]] std::size_t stride() const { return (((across_.cells + 7) / 8) | 1U) * 8; }

  void choose_rows_to_keep(std::size_t bands) {
    place_kept_.assign(upwards_.cells, not_kept);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < bands; ++k) {
      auto const [first, last] = band_of(k, bands);
      for (std::size_t row = first; row < last; ++row) {
        if (row - first < reach_y() || last - row <= reach_y()) place_kept_[row] = kept++;
      }
    }
    kept_.resize(kept * stride());
  }

  [[nodiscard]] PaddedRow padded_row() const {
    PaddedRow padded{.values = std::vector<double>(across_.cells + 2 * reach_x()), .places = {}};
    for (std::size_t n = 0; n <= 2 * reach_x(); ++n) padded.places.push_back(padded.values.data() + n);
    return padded;
  }
  void spread_along_x(std::size_t row, PaddedRow& padded, double* out) {
    double const* const values = values_of(row);
    std::size_t const reach = reach_x();
    std::copy_n(values, across_.cells, padded.values.data() + reach);
    for (std::size_t n = 1; n <= reach; ++n) {
      padded.values[reach - n] = values[across_.at(-offset(n))];
      padded.values[reach + across_.cells + n - 1] = values[across_.at(offset(across_.cells + n - 1))];
    }
    add_weighted_(padded.places.data() + reach, weights_x_, out, 0, across_.cells);
  }

  void keep_rows(Band band) {
    PaddedRow padded = padded_row();
    for (std::size_t row = band.first; row < band.last; ++row) {
      if (place_kept_[row] != not_kept) spread_along_x(row, padded, kept_.data() + place_kept_[row] * stride());
    }
  }

  void spread_band(Band band) {
    PaddedRow padded = padded_row();
    std::size_t const rows_of_window = std::min(band.last - band.first, rows_of_block + 2 * reach_y());
    UninitializedArray<double> window(rows_of_window * stride());
    auto const spread_row = [&](std::size_t row) {
      return place_kept_[row] != not_kept ? kept_.data() + place_kept_[row] * stride()
                                          : window.data() + row % rows_of_window * stride();
    };
    std::vector<double const*> rows(rows_of_block + 2 * reach_y());
    std::size_t next = band.first;
    for (std::size_t first = band.first; first < band.last; first += rows_of_block) {
      std::size_t const last = std::min(first + rows_of_block, band.last);
      for (; next < std::min(last + reach_y(), band.last); ++next) {
        if (place_kept_[next] == not_kept) spread_along_x(next, padded, spread_row(next));
      }
      for (std::size_t k = 0; k < last - first + 2 * reach_y(); ++k) {
        rows[k] = spread_row(upwards_.at(offset(first + k) - offset(reach_y())));
      }
      spread_block({.first = first, .last = last}, rows);
    }
  }
  void spread_block(Band block, std::span<double const* const> rows) {
    for (std::size_t column = 0; column < across_.cells; column += columns_of_block) {
      std::size_t const end = std::min(column + columns_of_block, across_.cells);
      for (std::size_t row = block.first; row < block.last; ++row) {
        add_weighted_(rows.data() + (row - block.first) + reach_y(), weights_y_, values_of(row), column, end);
      }
    }
  }

  std::span<double> values_;
  Line across_;
  Line upwards_;
  ThreadPool& threads_;
  AddWeighted add_weighted_;
  std::vector<double> weights_x_;
  std::vector<double> weights_y_;
  std::vector<std::size_t> place_kept_;  ///< of each row in kept_, or not_kept
  UninitializedArray<double> kept_;
};

void require_amount(Field const& field, char const* what, double amount) {
  if (amount >= 0.0 && std::isfinite(amount)) return;
  throw Error({.what = fmt::format("the field {} is to spread with {} = {}", field.name(), what, amount),
               .hint = "use a finite number from 0 on"});
}

}  // namespace

void spread(Field& field, Box const& box, Spreading const& amounts, ThreadPool& threads, Target instructions) {
  require_amount(field, "a diffusion", amounts.diffusion);
  require_amount(field, "a decay", amounts.decay);
  double const width = box.width() / static_cast<double>(field.columns());
  double const height = box.height() / static_cast<double>(field.rows());
  double const factor = decay(amounts.decay);
  double const lambda_x = amounts.diffusion / (width * width);
  double const lambda_y = amounts.diffusion / (height * height);
  if (amounts.diffusion > 0.0 || factor != 1.0) {
    Spread(field, box, threads, instructions).carry_out(lambda_x, lambda_y, factor);
  }
}

}  // namespace gridlock

#endif  // HWY_ONCE
