#include "core/avx512.hpp"
#include "engine/exact/candidates.hpp"
#include "engine/exact/earliest_contact.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>
#include <limits>

namespace gridlock::exact {

namespace {

constexpr std::size_t lanes = 8;
/// Largest number of candidates handled at once; a disk with more takes several rounds.
constexpr std::size_t max_candidates_here = 16;
static_assert(batch == lanes);

/// The disks of three cells in a row, moved to the front of a register; `count` is their number.
struct Run {
  __m512i names;
  unsigned count;
};

GRIDLOCK_AVX512 inline Run names_in_run(Index const* run, __m512i self, __m512i apart) {
  constexpr __mmask16 in_run = (1U << (3 * slots_per_cell)) - 1U;
  __m512i const names = _mm512_loadu_si512(run);
  __mmask16 const is_disk = _mm512_mask_cmpneq_epi32_mask(in_run, names, _mm512_set1_epi32(static_cast<int>(no_disk)));
  __mmask16 const is_other = _mm512_cmpneq_epi32_mask(names, self) & _mm512_cmpneq_epi32_mask(names, apart);
  auto const found = static_cast<__mmask16>(is_disk & is_other);
  return {_mm512_maskz_compress_epi32(found, names),
          static_cast<unsigned>(std::popcount(static_cast<unsigned>(found)))};
}

GRIDLOCK_AVX512 inline __m512i moved_up(Run const& run, unsigned places) {
  return _mm512_maskz_expand_epi32(static_cast<__mmask16>(((1U << run.count) - 1U) << places), run.names);
}

/// Collects the candidates of disk i, without `apart`. Three cells of four slots are contiguous and fit a register of
/// sixteen lanes.
/// Returns false where there may be too many.
GRIDLOCK_AVX512 inline bool collect(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  __m512i const other = _mm512_set1_epi32(static_cast<int>(apart));
  __m512i const nobody = _mm512_set1_epi32(static_cast<int>(s.nobody));
  if (s.neighbours != nullptr) {
    // The last of the sixteen lanes is the number of neighbours. Without `apart` one batch is mostly enough.
    __m512i const names = _mm512_load_si512(s.neighbours[i].disks);
    auto const others = static_cast<__mmask16>(_mm512_cmpneq_epi32_mask(names, other) & 0x7FFFU);
    _mm512_store_si512(candidates.disks, _mm512_mask_compress_epi32(nobody, others, names));
    candidates.count = s.neighbours[i].count -
                       (Neighbours::most - static_cast<unsigned>(std::popcount(static_cast<unsigned>(others))));
    return s.neighbours[i].has_all();
  }
  if (s.capacity != slots_per_cell) [[unlikely]]
    return false;
  Index const* const run = first_slot_around(s, i);
  __m512i const self = _mm512_set1_epi32(static_cast<int>(i));
  Run const below = names_in_run(run, self, other);
  Run const beside = names_in_run(run + s.row_stride, self, other);
  Run const above = names_in_run(run + 2 * s.row_stride, self, other);
  __m512i const all = _mm512_or_si512(
      below.names, _mm512_or_si512(moved_up(beside, below.count), moved_up(above, below.count + beside.count)));
  candidates.count = below.count + beside.count + above.count;
  auto const found = static_cast<__mmask16>((1U << std::min(candidates.count, max_candidates_here)) - 1U);
  _mm512_store_si512(candidates.disks, _mm512_mask_mov_epi32(nobody, found, all));
  return candidates.count <= max_candidates_here;
}

struct Columns {
  __m512d x, y, velocity_x, velocity_y, event_time, last_hit;
};

GRIDLOCK_AVX512 inline __m512d side_by_side(__m256d low, __m256d high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
}
GRIDLOCK_AVX512 inline __m256d side_by_side(__m128d low, __m128d high) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1);
}

/// Transposes the records of eight disks: from one cache line for a disk to one register for a quantity.
///
///     a = 0: x y vx vy │ 2: x y vx vy      unpack    x0 x1 vx0 vx1 │ x2 x3 vx2 vx3      shuffle   x0 … x7
///     b = 1: x y vx vy │ 3: x y vx vy      ──────→   y0 y1 vy0 vy1 │ y2 y3 vy2 vy3      ──────→   vx0 … vx7
GRIDLOCK_AVX512 inline Columns columns_of(MovingDisk const* disks, Index const* names) {
  auto const motions = [&](int low, int high) GRIDLOCK_AVX512 {
    return side_by_side(_mm256_load_pd(&disks[names[low]].x), _mm256_load_pd(&disks[names[high]].x));
  };
  auto const times = [&](int first) GRIDLOCK_AVX512 {
    auto const of = [&](int k) GRIDLOCK_AVX512 { return _mm_load_pd(&disks[names[first + k]].event_time); };
    return side_by_side(side_by_side(of(0), of(2)), side_by_side(of(4), of(6)));
  };
  __m512d const a = motions(0, 2);
  __m512d const b = motions(1, 3);
  __m512d const c = motions(4, 6);
  __m512d const d = motions(5, 7);
  __m512d const x_low = _mm512_unpacklo_pd(a, b);
  __m512d const x_high = _mm512_unpacklo_pd(c, d);
  __m512d const y_low = _mm512_unpackhi_pd(a, b);
  __m512d const y_high = _mm512_unpackhi_pd(c, d);
  __m512d const even = times(0);
  __m512d const odd = times(1);
  return {_mm512_shuffle_f64x2(x_low, x_high, 0b10001000),
          _mm512_shuffle_f64x2(y_low, y_high, 0b10001000),
          _mm512_shuffle_f64x2(x_low, x_high, 0b11011101),
          _mm512_shuffle_f64x2(y_low, y_high, 0b11011101),
          _mm512_unpacklo_pd(even, odd),
          _mm512_unpackhi_pd(even, odd)};
}

/// Loads the radii singly, because a gather takes longer.
GRIDLOCK_AVX512 inline __m512d radii_of(double const* radius, Index const* names) {
  auto const two = [&](int k)
                       GRIDLOCK_AVX512 { return _mm_loadh_pd(_mm_load_sd(radius + names[k]), radius + names[k + 1]); };
  return side_by_side(side_by_side(two(0), two(2)), side_by_side(two(4), two(6)));
}

/// Computes predict_border() with x and y in one register.
GRIDLOCK_AVX512 inline Prediction predict_border_packed(PredictionInput const& s, Index i, double now) {
  MovingDisk const& disk = s.disks[i];
  __m128d const zero = _mm_setzero_pd();
  __m128d const position = _mm_load_pd(&disk.x);
  __m128d const velocity = _mm_load_pd(&disk.velocity_x);
  __mmask8 const is_upwards = _mm_cmp_pd_mask(velocity, zero, _CMP_GT_OQ);
  __m128d const r = _mm_mul_pd(_mm_set1_pd(s.has_walls ? s.radius_of(i) : 0.0), _mm_loadu_pd(s.walls));
  __m128d edge;
  if (s.places != nullptr) {
    __m128d const place = _mm_loadu_pd(&s.places[i].x);
    __m128d const room = _mm_set1_pd(s.room);
    edge = _mm_mask_add_pd(_mm_sub_pd(place, room), is_upwards, place, room);
  } else {
    auto const upwards = static_cast<unsigned>(is_upwards);
    edge = _mm_loadh_pd(_mm_load_sd(s.column_limits + std::ptrdiff_t{2} * s.cells[i].column + (upwards & 1U)),
                        s.row_limits + std::ptrdiff_t{2} * s.cells[i].row + (upwards >> 1U));
  }
  edge = _mm_min_pd(_mm_max_pd(edge, r), _mm_sub_pd(_mm_loadu_pd(&s.width), r));
  __mmask8 const moves = _mm_cmp_pd_mask(velocity, zero, _CMP_NEQ_OQ);
  __m128d const infinite = _mm_set1_pd(std::numeric_limits<double>::infinity());
  __m128d const time = _mm_mask_div_pd(infinite, moves, _mm_sub_pd(edge, position), velocity);
  __m128d const y_time = _mm_unpackhi_pd(time, time);
  // Both borders are equally likely. An intrinsic is used because compilers may turn std::min() into a branch.
  auto const is_horizontal = static_cast<Index>(_mm_cmp_sd_mask(y_time, time, _CMP_LT_OQ));
  return {_mm_cvtsd_f64(_mm_max_sd(_mm_min_sd(y_time, time), _mm_set_sd(now))), vertical_border + is_horizontal};
}

/// Returns the shifts by which the nearest images are away, for separations that are d along an axis of this side.
GRIDLOCK_AVX512 inline __m512d shifts_to_nearest(__m512d d, double side, double by) {
  __mmask8 const above = _mm512_cmp_pd_mask(d, _mm512_set1_pd(0.5 * side), _CMP_GT_OQ);
  __mmask8 const below = _mm512_cmp_pd_mask(d, _mm512_set1_pd(-0.5 * side), _CMP_LT_OQ);
  __m512d const shift = _mm512_maskz_mov_pd(above, _mm512_set1_pd(-by));
  return _mm512_mask_mov_pd(shift, below, _mm512_set1_pd(by));
}

/// Returns the shifts of coordinates of separations that lead to the nearest images.
GRIDLOCK_AVX512 inline __m512d shifts_to_nearest(__m512d d, double side) { return shifts_to_nearest(d, side, side); }

/// Returns x of the separations from the nearest images in an oblique box, which are (now_x, now_y) now.
[[gnu::noinline]] GRIDLOCK_AVX512 __m512d nearest_in_oblique(PredictionInput const& s, __m512d d_x, __m512d now_x,
                                                             __m512d now_y) {
  __m512d const lean = shifts_to_nearest(now_y, s.period_y, s.lean);
  return _mm512_add_pd(d_x, _mm512_add_pd(lean, shifts_to_nearest(_mm512_add_pd(now_x, lean), s.period_x)));
}

GRIDLOCK_AVX512 inline __m512d dot(__m512d a_x, __m512d a_y, __m512d b_x, __m512d b_y) {
  return _mm512_add_pd(_mm512_mul_pd(a_x, b_x), _mm512_mul_pd(a_y, b_y));
}

template <bool grows>
GRIDLOCK_AVX512 inline Prediction border_of(PredictionInput const& s, Index i, double now) {
  if (s.falls) [[unlikely]]
    return predict_border_falling(s, i, now);
  return grows && s.has_walls ? predict_border_growing(s, i, now) : predict_border_packed(s, i, now);
}

/// Returns the first event among `best` and the contacts with the candidates. Inlined, it saves 2 % of the time.
template <bool grows>
[[gnu::always_inline]] GRIDLOCK_AVX512 inline Prediction earliest_of(PredictionInput const& s, Index i, double now,
                                                                     Candidates const& candidates, Prediction best) {
  MovingDisk const& self = s.disks[i];
  bool const needs_images = s.needs_images(i);
  double const radius = s.radius_of(i);
  __m512d const zero = _mm512_setzero_pd();
  __m512d const infinite = _mm512_set1_pd(std::numeric_limits<double>::infinity());
  __m512d const time_now = _mm512_set1_pd(now);
  __m512d sum = _mm512_set1_pd(radius + radius);
  for (std::size_t k = 0; k < candidates.count; k += lanes) {
    Index const* const eight = candidates.disks + k;
    Columns const other = columns_of(s.disks, eight);
    __m512d const begin = _mm512_max_pd(_mm512_set1_pd(self.last_hit), other.last_hit);
    __m512d const w_x = _mm512_sub_pd(other.velocity_x, _mm512_set1_pd(self.velocity_x));
    __m512d const w_y = _mm512_sub_pd(other.velocity_y, _mm512_set1_pd(self.velocity_y));
    __m512d d_x = _mm512_sub_pd(other.x, _mm512_set1_pd(self.x));
    __m512d d_y = _mm512_sub_pd(other.y, _mm512_set1_pd(self.y));
    if (needs_images) {
      __m512d const now_x = _mm512_add_pd(d_x, _mm512_mul_pd(w_x, time_now));
      __m512d const now_y = _mm512_add_pd(d_y, _mm512_mul_pd(w_y, time_now));
      d_x = s.lean == 0.0 ? _mm512_add_pd(d_x, shifts_to_nearest(now_x, s.period_x))
                          : nearest_in_oblique(s, d_x, now_x, now_y);
      d_y = _mm512_add_pd(d_y, shifts_to_nearest(now_y, s.period_y));
    }
    d_x = _mm512_add_pd(d_x, _mm512_mul_pd(w_x, begin));
    d_y = _mm512_add_pd(d_y, _mm512_mul_pd(w_y, begin));
    if (s.radius != nullptr) {
      sum = _mm512_add_pd(_mm512_set1_pd(radius), radii_of(s.radius, eight));
    }
    __m512d a = dot(w_x, w_y, w_x, w_y);
    __m512d b = dot(d_x, d_y, w_x, w_y);
    __m512d contact = sum;
    if constexpr (grows) {
      __m512d const rate = _mm512_set1_pd(s.scale.rate);
      __m512d const growth = _mm512_mul_pd(sum, rate);
      contact =
          _mm512_mul_pd(sum, _mm512_add_pd(_mm512_set1_pd(s.scale.at_zero),
                                           _mm512_add_pd(_mm512_set1_pd(s.scale.rest), _mm512_mul_pd(rate, begin))));
      a = _mm512_sub_pd(a, _mm512_mul_pd(growth, growth));
      b = _mm512_sub_pd(b, _mm512_mul_pd(growth, contact));
    }
    __m512d const squared_contact = _mm512_mul_pd(contact, contact);
    __m512d const c = _mm512_sub_pd(dot(d_x, d_y, d_x, d_y), squared_contact);
    __m512d const across = _mm512_sub_pd(_mm512_mul_pd(d_x, w_y), _mm512_mul_pd(d_y, w_x));
    __m512d const discriminant = grows
                                     ? _mm512_sub_pd(_mm512_mul_pd(b, b), _mm512_mul_pd(a, c))
                                     : _mm512_sub_pd(_mm512_mul_pd(a, squared_contact), _mm512_mul_pd(across, across));
    __m512d const wait = _mm512_div_pd(c, _mm512_sub_pd(_mm512_sqrt_pd(discriminant), b));
    __m512d const time = _mm512_max_pd(_mm512_add_pd(begin, wait), time_now);

    __mmask8 hits = _mm512_cmp_pd_mask(b, zero, _CMP_LT_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, discriminant, zero, _CMP_GE_OQ);
    hits = _mm512_mask_cmp_pd_mask(hits, time, other.event_time, _CMP_LT_OQ);
    double const earliest = _mm512_reduce_min_pd(_mm512_mask_mov_pd(infinite, hits, time));
    __mmask8 const firsts = _mm512_mask_cmp_pd_mask(hits, time, _mm512_set1_pd(earliest), _CMP_EQ_OQ);
    best = earlier_of(best, earliest, firsts, eight, s.disks);
    if constexpr (grows) {
      if (_mm512_cmp_pd_mask(a, zero, _CMP_LT_OQ) != 0) [[unlikely]]
        best = with_slow_ones(s, i, now, eight, std::min(lanes, candidates.count - k), best);
    }
  }
  return best;
}

/// Predicts for disk i, which has just collided with `apart`.
template <bool grows>
GRIDLOCK_AVX512 inline Prediction predict_beside(PredictionInput const& s, Index i, double now, Index apart,
                                                 Candidates const& candidates) {
  Prediction const best = earliest_of<grows>(s, i, now, candidates, border_of<grows>(s, i, now));
  return grows ? with_disk_apart(s, i, now, apart, best) : best;
}

/// Predicts for a disk with many candidates. `apart` is the disk it has just collided with, or no_disk.
template <bool grows>
GRIDLOCK_AVX512 Prediction predict_among_many(PredictionInput const& s, Index i, double now, Index apart) {
  Prediction const best = earliest_of_many(s, i, apart, border_of<grows>(s, i, now),
                                           [&](Candidates const& part, Prediction const& first)
                                               GRIDLOCK_AVX512 { return earliest_of<grows>(s, i, now, part, first); });
  return grows && apart != no_disk ? with_disk_apart(s, i, now, apart, best) : best;
}

template <bool grows>
GRIDLOCK_AVX512 Prediction predict(PredictionInput const& s, Index i, double now) {
  Candidates candidates;
  if (!collect(s, i, no_disk, candidates)) [[unlikely]] {
    return predict_among_many<grows>(s, i, now, no_disk);
  }
  return earliest_of<grows>(s, i, now, candidates, border_of<grows>(s, i, now));
}

template <bool grows>
GRIDLOCK_AVX512 PairPrediction predict_pair(PredictionInput const& s, Index i, Index j, double now) {
  // The disks around do not depend on the collision: they are collected while the new velocities are computed.
  Candidates around_i;
  Candidates around_j;
  bool const fits_i = collect(s, i, j, around_i);
  bool const fits_j = collect(s, j, i, around_j);
  if (!fits_i || !fits_j) [[unlikely]] {
    return {fits_i ? predict_beside<grows>(s, i, now, j, around_i) : predict_among_many<grows>(s, i, now, j),
            fits_j ? predict_beside<grows>(s, j, now, i, around_j) : predict_among_many<grows>(s, j, now, i)};
  }
  // Each prediction is returned as it is made: a copy would be read before its writes are done.
  return {predict_beside<grows>(s, i, now, j, around_i), predict_beside<grows>(s, j, now, i, around_j)};
}

}  // namespace

std::optional<Predictor> avx512_predictor(bool is_growing) {
  return is_growing ? Predictor{predict<true>, predict_pair<true>} : Predictor{predict<false>, predict_pair<false>};
}

}  // namespace gridlock::exact

#else

namespace gridlock::exact {

std::optional<Predictor> avx512_predictor(bool /*is_growing*/) { return std::nullopt; }

}  // namespace gridlock::exact

#endif
