#include "engine/exact/wide_candidates.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

namespace gridlock::exact {

bool can_use_avx512(PredictionInput const& s) {
  // In fewer cells a side the nearest image of a disk may not be the one in the neighbouring cell.
  bool const has_room = !s.is_periodic || (s.columns >= 5 && s.rows >= 5);
  return uses_avx512() && has_room && (s.capacity == slots_per_cell || s.neighbours != nullptr);
}

namespace {

/// The first of the border and the contacts with the candidates.
GRIDLOCK_AVX512 inline Prediction first_event(PredictionInput const& s, Index i, double now,
                                              Candidates const& candidates) {
  Prediction best = predict_border_packed(s, i, now);
  MovingDisk const& self = s.disks[i];
  bool const needs_images = is_at_periodic_edge(s, self);
  __m512d const zero = _mm512_setzero_pd();
  __m512d const time_now = _mm512_set1_pd(now);
  __m512d const self_x = _mm512_set1_pd(self.x);
  __m512d const self_y = _mm512_set1_pd(self.y);
  __m512d const self_velocity_x = _mm512_set1_pd(self.velocity_x);
  __m512d const self_velocity_y = _mm512_set1_pd(self.velocity_y);
  __m512d squared_contact = _mm512_set1_pd((s.equal_radius + s.equal_radius) * (s.equal_radius + s.equal_radius));
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    Index const* const names = candidates.disks + k;
    Columns const other = columns_of(s.disks, names);
    __m512d const w_x = _mm512_sub_pd(other.velocity_x, self_velocity_x);
    __m512d const w_y = _mm512_sub_pd(other.velocity_y, self_velocity_y);
    __m512d d_x = _mm512_add_pd(_mm512_sub_pd(other.x, self_x), _mm512_mul_pd(w_x, time_now));
    __m512d d_y = _mm512_add_pd(_mm512_sub_pd(other.y, self_y), _mm512_mul_pd(w_y, time_now));
    if (needs_images) {
      d_x = nearest_image(d_x, s.width);
      d_y = nearest_image(d_y, s.height);
    }
    if (s.radius != nullptr) {
      __m256i const places = _mm256_loadu_si256(reinterpret_cast<__m256i const*>(names));
      __m512d const contact =
          _mm512_add_pd(_mm512_set1_pd(s.radius[i]), _mm512_i32gather_pd(places, s.radius, sizeof(double)));
      squared_contact = _mm512_mul_pd(contact, contact);
    }
    __m512d const b = _mm512_add_pd(_mm512_mul_pd(d_x, w_x), _mm512_mul_pd(d_y, w_y));
    __m512d const c = _mm512_sub_pd(_mm512_add_pd(_mm512_mul_pd(d_x, d_x), _mm512_mul_pd(d_y, d_y)), squared_contact);
    __m512d const squared_speed = _mm512_add_pd(_mm512_mul_pd(w_x, w_x), _mm512_mul_pd(w_y, w_y));
    __m512d const discriminant = _mm512_sub_pd(_mm512_mul_pd(b, b), _mm512_mul_pd(squared_speed, c));
    __m512d const wait = _mm512_div_pd(c, _mm512_sub_pd(_mm512_sqrt_pd(discriminant), b));
    __m512d const time = _mm512_add_pd(time_now, _mm512_max_pd(wait, zero));

    auto hits = static_cast<__mmask8>((1U << (candidates.count - k)) - 1U);  // there are at most sixteen
    hits = _mm512_mask_cmp_pd_mask(hits, b, zero, _CMP_LT_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, discriminant, zero, _CMP_GE_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, time, other.event_time, _CMP_LT_OQ);
    best = earlier_of(best, hits, time, names, s.disks);
  }
  return best;
}

}  // namespace

GRIDLOCK_AVX512 Prediction predict_with_avx512(PredictionInput const& s, Index i, double now, Index apart) {
  Candidates candidates;
  if (!collect(s, i, apart, candidates)) [[unlikely]]
    return predict_scalar(s, i, now, apart);
  return first_event(s, i, now, candidates);
}

GRIDLOCK_AVX512 PairPrediction predict_pair_with_avx512(PredictionInput const& s, Index i, Index j, double now) {
  // What is around the two does not depend on their collision: collected first, it is found while the processor
  // still waits for the new velocities.
  Candidates around_i;
  Candidates around_j;
  bool const fits_i = collect(s, i, j, around_i);
  bool const fits_j = collect(s, j, i, around_j);
  if (!fits_i || !fits_j) [[unlikely]]
    return predict_pair_scalar(s, i, j, now);
  return {first_event(s, i, now, around_i), first_event(s, j, now, around_j)};
}

}  // namespace gridlock::exact

#else

namespace gridlock::exact {

bool can_use_avx512(PredictionInput const&) { return false; }
Prediction predict_with_avx512(PredictionInput const& s, Index i, double now, Index apart) {
  return predict_scalar(s, i, now, apart);
}
PairPrediction predict_pair_with_avx512(PredictionInput const& s, Index i, Index j, double now) {
  return predict_pair_scalar(s, i, j, now);
}

}  // namespace gridlock::exact

#endif
