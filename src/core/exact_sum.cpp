#include "gridlock/core/detail/exact_sum.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace gridlock {

namespace {

/// Number of terms that add(span) handles together.
constexpr std::size_t batch = 256;

/// Two numbers in one register of any processor; with them a compiler need not reorder a sum.
using Double2 = double __attribute__((vector_size(16)));
using Bits2 = std::int64_t __attribute__((vector_size(16)));

inline Double2 two_at(double const* terms) {
  Double2 result;
  std::memcpy(&result, terms, sizeof result);
  return result;
}

/// Returns Σ |x|, rounded; not finite where a term is not finite.
double sum_of_magnitudes(std::span<double const, batch> terms) {
  Bits2 const magnitude_bits = Bits2{} + std::numeric_limits<std::int64_t>::max();
  auto const magnitudes_at = [&](std::size_t k) {
    return reinterpret_cast<Double2>(reinterpret_cast<Bits2>(two_at(&terms[k])) & magnitude_bits);
  };
  Double2 even{};
  Double2 odd{};
  for (std::size_t k = 0; k < batch; k += 4) {
    even += magnitudes_at(k);
    odd += magnitudes_at(k + 2);
  }
  Double2 const sum = even + odd;
  return sum[0] + sum[1];
}

/// A term, or two in one register, in three parts: its leading bits, the following bits, and the rest.
template <class Number>
struct Parts {
  Number leading;
  Number following;
  Number rest;
};

/// The bits of x above the unit u = 2⁻⁵³σ are (σ + x) − σ, exactly for |x| ≤ σ/2, because σ + x has no finer bits. All
/// leading parts of a batch with Σ |x| ≤ σ/2 are multiples of u and together below σ, so that their sum is exact. The
/// rest of each term is at most u and is split in the same way.
/// Source: S. M. Rump, T. Ogita & S. Oishi, Accurate floating-point summation (2008), doi:10.1137/050645671.
template <class Number>
inline Parts<Number> parts_of(Number x, double sigma, double next_sigma) {
  Number const leading = (sigma + x) - sigma;
  Number const left = x - leading;
  Number const following = (next_sigma + left) - next_sigma;
  return {leading, following, left - following};
}

/// The sums of the parts of a batch.
struct SumsOfParts {
  Double2 leading{};
  Double2 following{};
  Bits2 has_rest{};

  void add(Double2 terms, double sigma, double next_sigma) {
    Parts const parts = parts_of(terms, sigma, next_sigma);
    leading += parts.leading;
    following += parts.following;
    has_rest |= parts.rest != 0.0;
  }
};

}  // namespace

void ExactSum::add(std::span<double const> terms) {
  // Between these magnitudes σ and the smaller powers of two that terms are rounded to are normal and finite.
  constexpr double least = 1e-200;
  constexpr double most = 1e300;
  for (; terms.size() >= batch; terms = terms.subspan(batch)) {
    auto const some = terms.first<batch>();
    double const magnitude = sum_of_magnitudes(some);
    if (magnitude == 0.0) continue;
    if (!(magnitude > least && magnitude < most)) {
      for (double const term : some) add(term);
      continue;
    }
    double const sigma = std::ldexp(1.0, std::ilogb(magnitude) + 2);
    // Twice the sum of the rests of a batch.
    double const next_sigma = sigma * 0x1p-44;
    SumsOfParts even;
    SumsOfParts odd;
    for (std::size_t k = 0; k < batch; k += 4) {
      even.add(two_at(&some[k]), sigma, next_sigma);
      odd.add(two_at(&some[k + 2]), sigma, next_sigma);
    }
    Double2 const leading = even.leading + odd.leading;
    Double2 const following = even.following + odd.following;
    add(leading[0] + leading[1]);
    add(following[0] + following[1]);
    Bits2 const has_rest = even.has_rest | odd.has_rest;
    if ((has_rest[0] | has_rest[1]) == 0) continue;
    for (double const term : some) add(parts_of(term, sigma, next_sigma).rest);
  }
  for (double const term : terms) add(term);
}

void ExactSum::add(ExactSum const& other) { add_packed(other.packed()); }

/// Returns the index of the first limb with a flag for each kind of term that is not finite above it, then the limbs.
std::vector<std::int64_t> ExactSum::packed() const {
  ExactSum carried = *this;
  carried.carry();
  auto first = carried.limbs_.begin() + carried.first_;
  auto end = first + (carried.end_ - std::min(carried.first_, carried.end_));
  while (end != first && *(end - 1) == 0) --end;
  while (first != end && *first == 0) ++first;
  auto head = static_cast<std::uint64_t>(first - carried.limbs_.begin());
  std::uint64_t flag = first_flag;
  for (bool const is_set : {has_positive_infinity_, has_negative_infinity_, has_nan_}) {
    if (is_set) head |= flag;
    flag *= 2;
  }
  std::vector<std::int64_t> numbers{static_cast<std::int64_t>(head)};
  numbers.insert(numbers.end(), first, end);
  return numbers;
}

void ExactSum::add_packed(std::span<std::int64_t const> numbers) {
  auto const head = static_cast<std::uint64_t>(numbers.front());
  has_positive_infinity_ = has_positive_infinity_ || (head & first_flag) != 0;
  has_negative_infinity_ = has_negative_infinity_ || (head & 2 * first_flag) != 0;
  has_nan_ = has_nan_ || (head & 4 * first_flag) != 0;
  std::span<std::int64_t const> const added = numbers.subspan(1);
  if (added.empty()) return;
  auto const first = static_cast<std::uint32_t>(head & (first_flag - 1));
  for (std::size_t k = 0; k < added.size(); ++k) limbs_[first + k] += added[k];
  first_ = std::min(first_, first);
  end_ = std::max(end_, first + static_cast<std::uint32_t>(added.size()));
  // A limb after a carry is smaller than a term, so the limbs cannot overflow before the next carry.
  if (--terms_until_carry_ == 0) carry();
}

void ExactSum::add_rare(double term) {
  if (std::isnan(term)) {
    has_nan_ = true;
  } else if (std::isinf(term)) {
    (term > 0.0 ? has_positive_infinity_ : has_negative_infinity_) = true;
  } else if (term != 0.0) {
    // Subnormal numbers have the unit of exponent 1.
    auto const bits = std::bit_cast<std::uint64_t>(term);
    add_mantissa(bits & mantissa_mask, 1, sign_of(bits));
  }
}

void ExactSum::carry() {
  terms_until_carry_ = terms_between_carries;
  if (first_ >= end_) return;
  std::int64_t carried = 0;
  std::uint32_t limb = first_;
  for (; limb + 1 < limbs && (limb < end_ || carried != 0); ++limb) {
    limbs_[limb] += carried;
    carried = limbs_[limb] / unit_of_next_limb;
    limbs_[limb] %= unit_of_next_limb;
  }
  if (carried != 0) limbs_[limb++] += carried;
  end_ = std::max(end_, limb);
}

double ExactSum::value() const {
  if (has_nan_ || (has_positive_infinity_ && has_negative_infinity_)) return std::numeric_limits<double>::quiet_NaN();
  if (has_positive_infinity_) return std::numeric_limits<double>::infinity();
  if (has_negative_infinity_) return -std::numeric_limits<double>::infinity();
  if (first_ >= end_) return 0.0;
  ExactSum magnitude = *this;
  magnitude.carry();
  std::size_t top = magnitude.end_;
  while (top > first_ && magnitude.limbs_[top - 1] == 0) --top;
  if (top == first_) return 0.0;
  // The limbs below the highest are together less than one unit of it.
  bool const is_negative = magnitude.limbs_[top - 1] < 0;
  std::int64_t borrowed = 0;
  for (std::size_t k = first_; k < top; ++k) {
    std::int64_t const limb = (is_negative ? -magnitude.limbs_[k] : magnitude.limbs_[k]) + borrowed;
    borrowed = k + 1 < top ? limb >> limb_bits : 0;
    magnitude.limbs_[k] = k + 1 < top ? limb & limb_mask : limb;
  }
  while (magnitude.limbs_[top - 1] == 0) --top;
  auto const limb_at = [&](std::size_t k) {
    return k < limbs ? static_cast<std::uint64_t>(magnitude.limbs_[k]) : std::uint64_t{0};
  };
  // The last limb is above the largest double.
  if (top == limbs)
    return is_negative ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity();
  // Bits are counted from that of 2⁻¹⁰⁷⁵, which is always 0: the lowest subnormal bit is bit 1.
  std::size_t const bits = (top - 1) * limb_bits + static_cast<std::size_t>(std::bit_width(limb_at(top - 1)));
  std::size_t const lowest = bits > mantissa_bits + 2 ? bits - (mantissa_bits + 1) : 1;
  std::size_t const limb = lowest / limb_bits;
  std::size_t const offset = lowest % limb_bits;
  // Three limbs from the lowest bit on hold at least 53 bits.
  std::uint64_t mantissa = (limb_at(limb) | limb_at(limb + 1) << limb_bits) >> offset;
  if (offset > 0) mantissa |= limb_at(limb + 2) << (64 - offset);
  auto const is_set = [&](std::size_t bit) { return ((limb_at(bit / limb_bits) >> (bit % limb_bits)) & 1) != 0; };
  if (is_set(lowest - 1)) {
    bool is_above_half =
        (limb_at((lowest - 1) / limb_bits) & ((std::uint64_t{1} << ((lowest - 1) % limb_bits)) - 1)) != 0;
    for (std::size_t k = first_; k < (lowest - 1) / limb_bits; ++k) is_above_half = is_above_half || limb_at(k) != 0;
    if (is_above_half || (mantissa & 1) != 0) ++mantissa;
  }
  // Mantissa and power of two are exact; only a value above the largest double becomes infinite.
  double const value = std::ldexp(static_cast<double>(mantissa), static_cast<int>(lowest) - 1075);
  return is_negative ? -value : value;
}

}  // namespace gridlock
