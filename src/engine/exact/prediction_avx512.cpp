#include "engine/exact/prediction.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

#include <bit>

#if !defined(__clang__)
// GCC 12 takes the deliberately undefined registers inside its own intrinsics for a mistake of the caller.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

// Only functions marked so use the wide registers; can_use_avx512() decides at run time whether they are ever called.
#define GRIDLOCK_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw")))

namespace gridlock::exact {

namespace {

constexpr std::size_t lanes = 8;
constexpr std::size_t most_slots_per_cell = 8;

/// The disks around disk i but for i and `apart`, moved together; zeros behind them, so that wide loads stay in bounds.
struct Candidates {
  alignas(64) Index disks[9 * most_slots_per_cell + 16];
  std::size_t count;
};

/// Three cells of four slots are a run of memory that one register of sixteen holds.
GRIDLOCK_AVX512 inline void collect(Surroundings const& s, Index i, Index apart, Candidates& candidates) {
  MovingDisk const& disk = s.disks[i];
  __m512i const none = _mm512_set1_epi32(static_cast<int>(no_disk));
  __m512i const self = _mm512_set1_epi32(static_cast<int>(i));
  __m512i const other = _mm512_set1_epi32(static_cast<int>(apart));
  Index const* run =
      s.slots + static_cast<std::size_t>(disk.row) * s.row_stride + static_cast<std::size_t>(disk.column) * s.capacity;
  std::size_t const length = 3 * s.capacity;
  std::size_t count = 0;
  for (int row = 0; row < 3; ++row, run += s.row_stride) {
    for (std::size_t k = 0; k < length; k += 16) {
      __mmask16 mask = length - k >= 16 ? __mmask16{0xFFFF} : static_cast<__mmask16>((1U << (length - k)) - 1U);
      __m512i const names = _mm512_loadu_si512(run + k);
      mask = _mm512_mask_cmpneq_epi32_mask(mask, names, none);
      mask = _mm512_mask_cmpneq_epi32_mask(mask, names, self);
      mask = _mm512_mask_cmpneq_epi32_mask(mask, names, other);
      _mm512_storeu_si512(candidates.disks + count, _mm512_maskz_compress_epi32(mask, names));
      count += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(mask)));
    }
  }
  candidates.count = count;
}

struct Columns {
  __m512d x, y, velocity_x, velocity_y, event_time;
};

/// The half lines of two disks side by side in one register.
GRIDLOCK_AVX512 inline __m512d two_disks(MovingDisk const& low, MovingDisk const& high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_load_pd(&low.x)), _mm256_load_pd(&high.x), 1);
}

GRIDLOCK_AVX512 inline __m256d four_times(MovingDisk const* disks, Index const* names) {
  __m128d const low = _mm_loadh_pd(_mm_load_sd(&disks[names[0]].event_time), &disks[names[1]].event_time);
  __m128d const high = _mm_loadh_pd(_mm_load_sd(&disks[names[2]].event_time), &disks[names[3]].event_time);
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1);
}

/// Eight disks transposed from one line a disk to one register a quantity.
///
///     a = 0: x y vx vy │ 2: x y vx vy      unpack    x0 x1 vx0 vx1 │ x2 x3 vx2 vx3      shuffle   x0 … x7
///     b = 1: x y vx vy │ 3: x y vx vy      ──────→   y0 y1 vy0 vy1 │ y2 y3 vy2 vy3      ──────→   vx0 … vx7
GRIDLOCK_AVX512 inline Columns columns_of(MovingDisk const* disks, Index const* names) {
  __m512d const a = two_disks(disks[names[0]], disks[names[2]]);
  __m512d const b = two_disks(disks[names[1]], disks[names[3]]);
  __m512d const c = two_disks(disks[names[4]], disks[names[6]]);
  __m512d const d = two_disks(disks[names[5]], disks[names[7]]);
  __m512d const x_low = _mm512_unpacklo_pd(a, b);
  __m512d const x_high = _mm512_unpacklo_pd(c, d);
  __m512d const y_low = _mm512_unpackhi_pd(a, b);
  __m512d const y_high = _mm512_unpackhi_pd(c, d);
  return {_mm512_shuffle_f64x2(x_low, x_high, 0b10001000), _mm512_shuffle_f64x2(y_low, y_high, 0b10001000),
          _mm512_shuffle_f64x2(x_low, x_high, 0b11011101), _mm512_shuffle_f64x2(y_low, y_high, 0b11011101),
          _mm512_insertf64x4(_mm512_castpd256_pd512(four_times(disks, names)), four_times(disks, names + 4), 1)};
}

GRIDLOCK_AVX512 inline __m512d nearest_image(__m512d d, double side) {
  __m512d const whole = _mm512_set1_pd(side);
  __mmask8 const above = _mm512_cmp_pd_mask(d, _mm512_set1_pd(0.5 * side), _CMP_GT_OQ);
  __mmask8 const below = _mm512_cmp_pd_mask(d, _mm512_set1_pd(-0.5 * side), _CMP_LT_OQ);
  d = _mm512_mask_sub_pd(d, above, d, whole);
  return _mm512_mask_add_pd(d, below, d, whole);
}

}  // namespace

bool can_use_avx512(Surroundings const& s) {
  bool const has_instructions = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                                __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  // In fewer cells a side the nearest image of a disk may not be the one in the neighbouring cell.
  bool const has_room = !s.is_periodic || (s.columns >= 5 && s.rows >= 5);
  return has_instructions && has_room && s.capacity <= most_slots_per_cell;
}

GRIDLOCK_AVX512 Prediction predict_with_avx512(Surroundings const& s, Index i, double now, Index apart) {
  Prediction best = predict_border(s, i, now);
  Candidates candidates;
  collect(s, i, apart, candidates);
  MovingDisk const& self = s.disks[i];
  __m512d const zero = _mm512_setzero_pd();
  __m512d const never = _mm512_set1_pd(std::numeric_limits<double>::infinity());
  __m512d const time_now = _mm512_set1_pd(now);
  __m512d contact = _mm512_set1_pd(s.equal_radius + s.equal_radius);
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    Index const* const names = candidates.disks + k;
    Columns const other = columns_of(s.disks, names);
    __m512d const w_x = _mm512_sub_pd(other.velocity_x, _mm512_set1_pd(self.velocity_x));
    __m512d const w_y = _mm512_sub_pd(other.velocity_y, _mm512_set1_pd(self.velocity_y));
    __m512d d_x = _mm512_add_pd(_mm512_sub_pd(other.x, _mm512_set1_pd(self.x)), _mm512_mul_pd(w_x, time_now));
    __m512d d_y = _mm512_add_pd(_mm512_sub_pd(other.y, _mm512_set1_pd(self.y)), _mm512_mul_pd(w_y, time_now));
    if (s.is_periodic) {
      d_x = nearest_image(d_x, s.width);
      d_y = nearest_image(d_y, s.height);
    }
    if (s.radius != nullptr) {
      __m256i const places = _mm256_loadu_si256(reinterpret_cast<__m256i const*>(names));
      contact = _mm512_add_pd(_mm512_set1_pd(s.radius[i]), _mm512_i32gather_pd(places, s.radius, sizeof(double)));
    }
    __m512d const b = _mm512_add_pd(_mm512_mul_pd(d_x, w_x), _mm512_mul_pd(d_y, w_y));
    __m512d const c =
        _mm512_sub_pd(_mm512_add_pd(_mm512_mul_pd(d_x, d_x), _mm512_mul_pd(d_y, d_y)), _mm512_mul_pd(contact, contact));
    __m512d const squared_speed = _mm512_add_pd(_mm512_mul_pd(w_x, w_x), _mm512_mul_pd(w_y, w_y));
    __m512d const discriminant = _mm512_sub_pd(_mm512_mul_pd(b, b), _mm512_mul_pd(squared_speed, c));
    __m512d const wait = _mm512_div_pd(c, _mm512_sub_pd(_mm512_sqrt_pd(discriminant), b));
    __m512d const time = _mm512_add_pd(time_now, _mm512_max_pd(wait, zero));

    std::size_t const left = candidates.count - k;
    __mmask8 hits = left >= lanes ? __mmask8{0xFF} : static_cast<__mmask8>((1U << left) - 1U);
    hits = _mm512_mask_cmp_pd_mask(hits, b, zero, _CMP_LT_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, discriminant, zero, _CMP_GE_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, time, other.event_time, _CMP_LT_OQ);
    double const earliest = _mm512_reduce_min_pd(_mm512_mask_mov_pd(never, hits, time));
    __mmask8 const first = _mm512_mask_cmp_pd_mask(hits, time, _mm512_set1_pd(earliest), _CMP_EQ_OQ);
    unsigned const firsts = first;
    if ((firsts & (firsts - 1U)) != 0 || earliest == best.time) [[unlikely]] {
      for (unsigned rest = firsts; rest != 0; rest &= rest - 1U) {
        Index const j = names[std::countr_zero(rest)];
        bool const is_tie = earliest == best.time && best.partner < vertical_border;
        if (earliest < best.time || (is_tie && s.disks[j].rank < s.disks[best.partner].rank)) best = {earliest, j};
      }
    } else {
      Index const j = names[std::countr_zero(firsts | 0x80U)];
      bool const is_earlier = earliest < best.time;
      best = {is_earlier ? earliest : best.time, is_earlier ? j : best.partner};
    }
  }
  return best;
}

}  // namespace gridlock::exact

#else

namespace gridlock::exact {

bool can_use_avx512(Surroundings const&) { return false; }
Prediction predict_with_avx512(Surroundings const& s, Index i, double now, Index apart) {
  return predict_plainly(s, i, now, apart);
}

}  // namespace gridlock::exact

#endif
