#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/decay.hpp"
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
void add_weighted(double const* const* rows, std::span<double const> weights, double* out, std::size_t count) {
  hn::ScalableTag<double> const tag;
  std::size_t const lanes = hn::Lanes(tag);
  auto const reach = static_cast<std::ptrdiff_t>(weights.size());
  std::size_t k = 0;
  // Two registers at a time hide the delay of an addition.
  for (; k + 2 * lanes <= count; k += 2 * lanes) {
    auto const first = hn::Set(tag, weights[0]);
    auto sum = hn::Mul(first, hn::LoadU(tag, rows[0] + k));
    auto next = hn::Mul(first, hn::LoadU(tag, rows[0] + k + lanes));
    for (std::ptrdiff_t n = 1; n < reach; ++n) {
      auto const weight = hn::Set(tag, weights[static_cast<std::size_t>(n)]);
      double const* const low = rows[-n] + k;
      double const* const high = rows[n] + k;
      sum = hn::Add(sum, hn::Mul(weight, hn::Add(hn::LoadU(tag, low), hn::LoadU(tag, high))));
      next = hn::Add(next, hn::Mul(weight, hn::Add(hn::LoadU(tag, low + lanes), hn::LoadU(tag, high + lanes))));
    }
    hn::StoreU(sum, tag, out + k);
    hn::StoreU(next, tag, out + k + lanes);
  }
  for (; k < count; ++k) out[k] = weighted_sum(rows, weights, k);
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

namespace {

using AddWeighted = void (*)(double const* const* rows, std::span<double const> weights, double* out,
                             std::size_t count);

/// Sets out[k] to weighted_sum(rows, weights, k) for each k below `count`.
void add_weighted_plain(double const* const* rows, std::span<double const> weights, double* out, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) out[k] = weighted_sum(rows, weights, k);
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

/// Rows that one thread spreads along x at a time, and columns along y, of which a copy stays in the second cache.
constexpr std::size_t rows_per_part = 16;
constexpr std::size_t columns_per_part = 64;

class Spread {
 public:
  Spread(Field& field, Box const& box, ThreadPool& threads, Target instructions)
      : values_(field.values()),
        across_{.cells = field.columns(), .is_periodic = box.is_periodic_x()},
        upwards_{.cells = field.rows(), .is_periodic = box.is_periodic_y()},
        threads_(threads),
        add_weighted_(add_weighted_for(instructions)) {}

  void along_x(double lambda) {
    std::size_t const columns = across_.cells;
    if (lambda >= lambda_of_uniform(across_)) return make_uniform_along_x();
    std::vector<double> const weights = weights_of(lambda);
    std::size_t const reach = weights.size() - 1;
    for_each_part_of_rows([&](std::size_t first, std::size_t last) {
      std::vector<double> padded(columns + 2 * reach);
      std::vector<double const*> places(2 * reach + 1);
      for (std::size_t n = 0; n < places.size(); ++n) places[n] = padded.data() + n;
      for (std::size_t row = first; row < last; ++row) {
        double* const values = values_.data() + row * columns;
        std::copy_n(values, columns, padded.begin() + static_cast<std::ptrdiff_t>(reach));
        for (std::size_t n = 1; n <= reach; ++n) {
          padded[reach - n] = values[across_.at(-static_cast<std::ptrdiff_t>(n))];
          padded[reach + columns + n - 1] = values[across_.at(static_cast<std::ptrdiff_t>(columns + n - 1))];
        }
        add_weighted_(places.data() + reach, weights, values, columns);
      }
    });
  }

  void along_y(double lambda, double factor) {
    std::size_t const columns = across_.cells;
    if (lambda >= lambda_of_uniform(upwards_)) {
      make_uniform_along_y();
      lambda = 0.0;
    }
    std::vector<double> weights = lambda > 0.0 ? weights_of(lambda) : std::vector<double>{1.0};
    for (double& weight : weights) weight *= factor;
    std::size_t const parts = (columns + columns_per_part - 1) / columns_per_part;
    threads_.for_each(parts, [&](std::size_t part) {
      std::size_t const first = part * columns_per_part;
      spread_strip(first, std::min(columns_per_part, columns - first), weights);
    });
  }

 private:
  template <class SpreadRows>
  void for_each_part_of_rows(SpreadRows spread_rows) {
    std::size_t const parts = (upwards_.cells + rows_per_part - 1) / rows_per_part;
    threads_.for_each(parts, [&](std::size_t part) {
      std::size_t const first = part * rows_per_part;
      spread_rows(first, std::min(first + rows_per_part, upwards_.cells));
    });
  }

  /// Spreads some columns along y.
  void spread_strip(std::size_t first, std::size_t width, std::span<double const> weights) {
    std::size_t const reach = weights.size() - 1;
    std::vector<double> before(upwards_.cells * width);
    for (std::size_t row = 0; row < upwards_.cells; ++row) {
      std::ranges::copy(values_.subspan(row * across_.cells + first, width), before.begin() + offset(row * width));
    }
    std::vector<double const*> rows(upwards_.cells + 2 * reach);
    for (std::size_t k = 0; k < rows.size(); ++k)
      rows[k] = before.data() + upwards_.at(offset(k) - offset(reach)) * width;
    for (std::size_t row = 0; row < upwards_.cells; ++row) {
      add_weighted_(rows.data() + row + reach, weights, values_.data() + row * across_.cells + first, width);
    }
  }
  static std::ptrdiff_t offset(std::size_t count) { return static_cast<std::ptrdiff_t>(count); }

  void make_uniform_along_x() {
    for_each_part_of_rows([&](std::size_t first, std::size_t last) {
      for (std::size_t row = first; row < last; ++row) {
        std::span<double> const values = values_.subspan(row * across_.cells, across_.cells);
        double sum = 0.0;
        for (double const value : values) sum += value;
        std::ranges::fill(values, sum / static_cast<double>(values.size()));
      }
    });
  }
  void make_uniform_along_y() {
    std::size_t const columns = across_.cells;
    for (std::size_t column = 0; column < columns; ++column) {
      double sum = 0.0;
      for (std::size_t row = 0; row < upwards_.cells; ++row) sum += values_[row * columns + column];
      double const mean = sum / static_cast<double>(upwards_.cells);
      for (std::size_t row = 0; row < upwards_.cells; ++row) values_[row * columns + column] = mean;
    }
  }

  std::span<double> values_;
  Line across_;
  Line upwards_;
  ThreadPool& threads_;
  AddWeighted add_weighted_;
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
  Spread field_to_spread(field, box, threads, instructions);
  if (lambda_x > 0.0) field_to_spread.along_x(lambda_x);
  if (lambda_y > 0.0 || factor != 1.0) field_to_spread.along_y(lambda_y, factor);
}

}  // namespace gridlock

#endif  // HWY_ONCE
