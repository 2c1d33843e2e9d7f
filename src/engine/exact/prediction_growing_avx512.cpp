#include "engine/exact/growing_candidates.hpp"
#include "engine/exact/wide_candidates.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

namespace gridlock::exact {

namespace {

/// By how much a coordinate of a separation is to be moved to be the nearest image.
GRIDLOCK_AVX512 inline __m512d shifts_to_nearest(__m512d d, double side) {
  __mmask8 const above = _mm512_cmp_pd_mask(d, _mm512_set1_pd(0.5 * side), _CMP_GT_OQ);
  __mmask8 const below = _mm512_cmp_pd_mask(d, _mm512_set1_pd(-0.5 * side), _CMP_LT_OQ);
  __m512d const shift = _mm512_maskz_mov_pd(above, _mm512_set1_pd(-side));
  return _mm512_mask_mov_pd(shift, below, _mm512_set1_pd(side));
}

GRIDLOCK_AVX512 inline __m512d dot(__m512d a_x, __m512d a_y, __m512d b_x, __m512d b_y) {
  return _mm512_add_pd(_mm512_mul_pd(a_x, b_x), _mm512_mul_pd(a_y, b_y));
}

/// Eight candidates of a disk, from the moments at which the velocity of one of each two last changed.
struct Approaches {
  __m512d begin, a, b, c;    // see Predict for growing disks
  __m512d shift_x, shift_y;  // to the nearest image
};

GRIDLOCK_AVX512 inline Approaches approaches_of(PredictionInput const& s, Index i, double now, Index const* names,
                                                Columns const& other, bool needs_images) {
  MovingDisk const& self = s.disks[i];
  __m256i const places = _mm256_loadu_si256(reinterpret_cast<__m256i const*>(names));
  __m512d const begin =
      _mm512_max_pd(_mm512_set1_pd(s.last_hit[i]), _mm512_i32gather_pd(places, s.last_hit, sizeof(double)));
  __m512d const w_x = _mm512_sub_pd(other.velocity_x, _mm512_set1_pd(self.velocity_x));
  __m512d const w_y = _mm512_sub_pd(other.velocity_y, _mm512_set1_pd(self.velocity_y));
  __m512d d_x = _mm512_sub_pd(other.x, _mm512_set1_pd(self.x));
  __m512d d_y = _mm512_sub_pd(other.y, _mm512_set1_pd(self.y));
  __m512d shift_x = _mm512_setzero_pd();
  __m512d shift_y = _mm512_setzero_pd();
  if (needs_images) {
    shift_x = shifts_to_nearest(_mm512_add_pd(d_x, _mm512_mul_pd(w_x, _mm512_set1_pd(now))), s.width);
    shift_y = shifts_to_nearest(_mm512_add_pd(d_y, _mm512_mul_pd(w_y, _mm512_set1_pd(now))), s.height);
    d_x = _mm512_add_pd(d_x, shift_x);
    d_y = _mm512_add_pd(d_y, shift_y);
  }
  d_x = _mm512_add_pd(d_x, _mm512_mul_pd(w_x, begin));
  d_y = _mm512_add_pd(d_y, _mm512_mul_pd(w_y, begin));
  __m512d const sum = _mm512_add_pd(_mm512_set1_pd(s.radius[i]), _mm512_i32gather_pd(places, s.radius, sizeof(double)));
  __m512d const rate = _mm512_set1_pd(s.scale.rate);
  __m512d const scale = _mm512_add_pd(_mm512_set1_pd(s.scale.at_zero),
                                      _mm512_add_pd(_mm512_set1_pd(s.scale.rest), _mm512_mul_pd(rate, begin)));
  __m512d const contact = _mm512_mul_pd(sum, scale);
  __m512d const growth = _mm512_mul_pd(sum, rate);
  return {begin,
          _mm512_sub_pd(dot(w_x, w_y, w_x, w_y), _mm512_mul_pd(growth, growth)),
          _mm512_sub_pd(dot(d_x, d_y, w_x, w_y), _mm512_mul_pd(growth, contact)),
          _mm512_sub_pd(dot(d_x, d_y, d_x, d_y), _mm512_mul_pd(contact, contact)),
          shift_x,
          shift_y};
}

/// The first of `best` and the contacts with candidates that part more slowly than they grow: rare, and looked at one by one.
GRIDLOCK_AVX512 inline Prediction with_slow_ones(PredictionInput const& s, Index i, double now, Index const* names,
                                                 Approaches const& pairs, unsigned slow, Prediction best) {
  alignas(64) double shift_x[lanes];
  alignas(64) double shift_y[lanes];
  _mm512_store_pd(shift_x, pairs.shift_x);
  _mm512_store_pd(shift_y, pairs.shift_y);
  EarliestGrowing earliest(s, i, now, no_disk, best);
  for (; slow != 0; slow &= slow - 1U) {
    int const lane = std::countr_zero(slow);
    earliest.consider(names[lane], shift_x[lane], shift_y[lane]);
  }
  return earliest.best();
}

/// The first of the border and the contacts with the candidates.
GRIDLOCK_AVX512 inline Prediction first_contact(PredictionInput const& s, Index i, double now,
                                                Candidates const& candidates) {
  bool const is_in_cell_only = s.is_periodic && s.places == nullptr;
  Prediction best = is_in_cell_only ? predict_border_packed(s, i, now) : border_growing(s, i, now);
  bool const needs_images = is_at_periodic_edge(s, s.disks[i]);
  __m512d const zero = _mm512_setzero_pd();
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    Index const* const names = candidates.disks + k;
    Columns const other = columns_of(s.disks, names);
    Approaches const pairs = approaches_of(s, i, now, names, other, needs_images);
    __m512d const discriminant = _mm512_sub_pd(_mm512_mul_pd(pairs.b, pairs.b), _mm512_mul_pd(pairs.a, pairs.c));
    __m512d const wait = _mm512_div_pd(pairs.c, _mm512_sub_pd(_mm512_sqrt_pd(discriminant), pairs.b));
    __m512d const time = _mm512_max_pd(_mm512_add_pd(pairs.begin, wait), _mm512_set1_pd(now));

    auto const all = static_cast<__mmask8>((1U << (candidates.count - k)) - 1U);  // there are at most sixteen
    __mmask8 hits = _mm512_mask_cmp_pd_mask(all, pairs.b, zero, _CMP_LT_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, discriminant, zero, _CMP_GE_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, time, other.event_time, _CMP_LT_OQ);
    best = earlier_of(best, hits, time, names, s.disks);
    unsigned const slow = _mm512_mask_cmp_pd_mask(all, pairs.a, zero, _CMP_LT_OQ);
    if (slow != 0) [[unlikely]]
      best = with_slow_ones(s, i, now, names, pairs, slow, best);
  }
  return best;
}

/// The disks that i may meet but for `apart`: those of its list where it has one, or of the cells around it.
/// Returns false where there are too many.
GRIDLOCK_AVX512 inline bool collect_growing(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  if (s.neighbours != nullptr && s.neighbours[i].has_all()) {
    __m512i const names = _mm512_load_si512(s.neighbours[i].disks);
    auto const listed = static_cast<__mmask16>((1U << s.neighbours[i].count) - 1U);
    __mmask16 const found = _mm512_mask_cmpneq_epi32_mask(listed, names, _mm512_set1_epi32(static_cast<int>(apart)));
    _mm512_store_si512(candidates.disks, _mm512_maskz_compress_epi32(found, names));
    candidates.count = static_cast<std::size_t>(std::popcount(static_cast<unsigned>(found)));
    return true;
  }
  return s.capacity == slots_per_cell && collect(s, i, apart, candidates);
}

}  // namespace

GRIDLOCK_AVX512 Prediction predict_growing_with_avx512(PredictionInput const& s, Index i, double now, Index apart) {
  Candidates candidates;
  if (!collect_growing(s, i, apart, candidates)) [[unlikely]]
    return predict_growing(s, i, now, apart);
  Prediction const best = first_contact(s, i, now, candidates);
  return apart == no_disk ? best : with_disk_apart(s, i, now, apart, best);
}

GRIDLOCK_AVX512 PairPrediction predict_pair_growing_with_avx512(PredictionInput const& s, Index i, Index j,
                                                                double now) {
  Candidates around_i;
  Candidates around_j;
  bool const fits_i = collect_growing(s, i, j, around_i);
  bool const fits_j = collect_growing(s, j, i, around_j);
  if (!fits_i || !fits_j) [[unlikely]]
    return predict_pair_growing(s, i, j, now);
  return {with_disk_apart(s, i, now, j, first_contact(s, i, now, around_i)),
          with_disk_apart(s, j, now, i, first_contact(s, j, now, around_j))};
}

}  // namespace gridlock::exact

#else

namespace gridlock::exact {

Prediction predict_growing_with_avx512(PredictionInput const& s, Index i, double now, Index apart) {
  return predict_growing(s, i, now, apart);
}
PairPrediction predict_pair_growing_with_avx512(PredictionInput const& s, Index i, Index j, double now) {
  return predict_pair_growing(s, i, j, now);
}

}  // namespace gridlock::exact

#endif
