#include "packing/quasi_newton.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "core/avx512.hpp"
#include "packing/block_sums.hpp"

namespace gridlock {

namespace {

/// Number of remembered steps. Of 2 to 10, five need the fewest evaluations of forces (docs/notebook/jamming.md).
constexpr std::size_t max_pairs = 5;

/// Partial sums, as many as the widest registers need, so that registers of any width give the same bits.
using Lanes = std::array<double, 32>;

/// Adds the last products a b, fewer than there are lanes, to the lanes; returns the sum of all lanes.
double finish(Lanes& sums, double const* a, double const* b, std::size_t first, std::size_t end) {
  for (std::size_t k = first; k < end; ++k) sums[k - first] += a[k] * b[k];
  for (std::size_t half = sums.size() / 2; half > 0; half /= 2) {
    for (std::size_t lane = 0; lane < half; ++lane) sums[lane] += sums[lane + half];
  }
  return sums[0];
}

/// Returns Σ a b over the numbers from `first` to `end`.
double multiply_plainly(double const* a, double const* b, std::size_t first, std::size_t end) {
  Lanes sums{};
  std::size_t k = first;
  for (; k + sums.size() <= end; k += sums.size()) {
    for (std::size_t lane = 0; lane < sums.size(); ++lane) sums[lane] += a[k + lane] * b[k + lane];
  }
  return finish(sums, a, b, k, end);
}

/// b ← b + factor a.
void add_plainly(double* b, double factor, double const* a, std::size_t first, std::size_t end) {
  for (std::size_t k = first; k < end; ++k) b[k] += factor * a[k];
}

#ifdef GRIDLOCK_AVX512
GRIDLOCK_AVX512 __m512d product_of_eight(double const* a, double const* b) {
  return _mm512_mul_pd(_mm512_loadu_pd(a), _mm512_loadu_pd(b));
}

GRIDLOCK_AVX512 double multiply_wide(double const* a, double const* b, std::size_t first, std::size_t end) {
  __m512d sum_0 = _mm512_setzero_pd();
  __m512d sum_8 = sum_0;
  __m512d sum_16 = sum_0;
  __m512d sum_24 = sum_0;
  std::size_t k = first;
  for (; k + 32 <= end; k += 32) {
    sum_0 = _mm512_add_pd(sum_0, product_of_eight(a + k, b + k));
    sum_8 = _mm512_add_pd(sum_8, product_of_eight(a + k + 8, b + k + 8));
    sum_16 = _mm512_add_pd(sum_16, product_of_eight(a + k + 16, b + k + 16));
    sum_24 = _mm512_add_pd(sum_24, product_of_eight(a + k + 24, b + k + 24));
  }
  Lanes sums;
  _mm512_storeu_pd(sums.data(), sum_0);
  _mm512_storeu_pd(&sums[8], sum_8);
  _mm512_storeu_pd(&sums[16], sum_16);
  _mm512_storeu_pd(&sums[24], sum_24);
  return finish(sums, a, b, k, end);
}

GRIDLOCK_AVX512 void add_wide(double* b, double factor, double const* a, std::size_t first, std::size_t end) {
  __m512d const factors = _mm512_set1_pd(factor);
  std::size_t k = first;
  for (; k + 8 <= end; k += 8) {
    __m512d const added = _mm512_mul_pd(factors, _mm512_loadu_pd(a + k));
    _mm512_storeu_pd(b + k, _mm512_add_pd(_mm512_loadu_pd(b + k), added));
  }
  add_plainly(b, factor, a, k, end);
}
#endif

struct Kernels {
  double (*multiply)(double const*, double const*, std::size_t, std::size_t) = multiply_plainly;
  void (*add)(double*, double, double const*, std::size_t, std::size_t) = add_plainly;
};

Kernels kernels() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return {.multiply = multiply_wide, .add = add_wide};
#endif
  return {};
}

double dot(Columns const& a, Columns const& b, ThreadPool& pool) {
  Kernels const kernel = kernels();
  return sum_over_blocks<double>(a.x.size(), pool, [&](std::size_t first, std::size_t end) {
    double const x = kernel.multiply(a.x.data(), b.x.data(), first, end);
    return x + kernel.multiply(a.y.data(), b.y.data(), first, end);
  });
}

/// Computes step ← step + factor · added and returns step · other, in one pass through memory.
double add_and_dot(Columns& step, double factor, Columns const& added, Columns const& other, ThreadPool& pool) {
  Kernels const kernel = kernels();
  return sum_over_blocks<double>(step.x.size(), pool, [&](std::size_t first, std::size_t end) {
    kernel.add(step.x.data(), factor, added.x.data(), first, end);
    kernel.add(step.y.data(), factor, added.y.data(), first, end);
    double const x = kernel.multiply(step.x.data(), other.x.data(), first, end);
    return x + kernel.multiply(step.y.data(), other.y.data(), first, end);
  });
}

}  // namespace

double QuasiNewton::find_direction(Columns const& force, Columns& step, ThreadPool& pool) {
  step = force;
  std::array<double, max_pairs> shares{};
  // Each pass adds one term and computes the product that the next pass needs.
  std::size_t const count = pairs_.size();
  double product = dot(force, count > 0 ? pairs_.back().step : force, pool);
  for (std::size_t k = count; k-- > 0;) {
    shares[k] = product / pairs_[k].curvature;
    product = add_and_dot(step, -shares[k], pairs_[k].change, k > 0 ? pairs_[k - 1].step : pairs_[0].change, pool);
  }
  double const scale = count > 0 ? pairs_.back().scale : first_scale_;
  for (std::size_t i = 0; i < disks_; ++i) {
    step.x[i] *= scale;
    step.y[i] *= scale;
  }
  product *= scale;
  for (std::size_t k = 0; k < count; ++k) {
    double const share = shares[k] - product / pairs_[k].curvature;
    product = add_and_dot(step, share, pairs_[k].step, k + 1 < count ? pairs_[k + 1].change : force, pool);
  }
  return product;
}

void QuasiNewton::remember(Columns const& step, double scale, Columns const& force_before, Columns const& force_after,
                           ThreadPool& pool) {
  Pair pair{.step = Columns(disks_), .change = Columns(disks_)};
  if (pairs_.size() == max_pairs) {
    pair = std::move(pairs_.front());
    pairs_.erase(pairs_.begin());
  }
  for (std::size_t i = 0; i < disks_; ++i) {
    pair.step.x[i] = scale * step.x[i];
    pair.step.y[i] = scale * step.y[i];
    pair.change.x[i] = force_before.x[i] - force_after.x[i];
    pair.change.y[i] = force_before.y[i] - force_after.y[i];
  }
  pair.curvature = dot(pair.step, pair.change, pool);
  double const square = dot(pair.change, pair.change, pool);
  // A curvature of 0 up to rounding would make the next step arbitrarily long.
  if (!(pair.curvature > 1e-12 * square * first_scale_)) return;
  pair.scale = pair.curvature / square;
  pairs_.push_back(std::move(pair));
}

void QuasiNewton::forget(double first_scale) {
  first_scale_ = first_scale;
  pairs_.clear();
}

void QuasiNewton::serialize(Archive& archive) {
  archive.visit("first_scale", first_scale_);
  std::uint64_t count = pairs_.size();
  archive.visit("steps", count);
  archive.require(count <= max_pairs, "a minimization remembers too many steps");
  pairs_.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    Pair& pair = pairs_[k];
    serialize_inside(archive, fmt::format("step_{}", k), [&] {
      for (auto const& [name, column] :
           {std::pair{"step_x", &pair.step.x}, std::pair{"step_y", &pair.step.y}, std::pair{"change_x", &pair.change.x},
            std::pair{"change_y", &pair.change.y}}) {
        archive.visit(name, *column);
        archive.require(column->size() == disks_, "a minimization remembers steps of another number of disks");
      }
      archive.visit("curvature", pair.curvature);
      archive.visit("scale", pair.scale);
    });
  }
}

}  // namespace gridlock
