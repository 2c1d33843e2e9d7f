#pragma once

// The candidates of a prediction side by side in wide registers, for every kernel that takes eight at a time.

#include "core/avx512.hpp"
#include "engine/exact/prediction.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>
#include <limits>

namespace gridlock::exact {

inline constexpr std::size_t lanes = 8;
inline constexpr std::size_t slots_per_cell = 4;

/// The disks around disk i but for i and `apart`, moved together; zeros behind them.
struct Candidates {
  alignas(64) Index disks[16];
  std::size_t count;
};

/// The names in one run of three cells, moved to the front of a register, after `count` others.
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

/// Three cells of four slots are a run of memory that one register of sixteen holds.
/// Returns false where there are more than sixteen candidates.
GRIDLOCK_AVX512 inline bool collect(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  MovingDisk const& disk = s.disks[i];
  Index const* const run = s.slots + static_cast<std::size_t>(disk.row) * s.row_stride +
                           static_cast<std::size_t>(disk.column) * slots_per_cell;
  __m512i const self = _mm512_set1_epi32(static_cast<int>(i));
  __m512i const other = _mm512_set1_epi32(static_cast<int>(apart));
  Run const below = names_in_run(run, self, other);
  Run const beside = names_in_run(run + s.row_stride, self, other);
  Run const above = names_in_run(run + 2 * s.row_stride, self, other);
  __m512i const all = _mm512_or_si512(
      below.names, _mm512_or_si512(moved_up(beside, below.count), moved_up(above, below.count + beside.count)));
  _mm512_store_si512(candidates.disks, all);
  candidates.count = below.count + beside.count + above.count;
  return candidates.count <= 16;
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

/// predict_border(), the two directions side by side.
GRIDLOCK_AVX512 inline Prediction predict_border_packed(PredictionInput const& s, Index i, double now) {
  MovingDisk const& disk = s.disks[i];
  __m128d const zero = _mm_setzero_pd();
  __m128d const place = _mm_load_pd(&disk.x);
  __m128d const velocity = _mm_load_pd(&disk.velocity_x);
  auto const upwards = static_cast<unsigned>(_mm_cmp_pd_mask(velocity, zero, _CMP_GT_OQ));
  __m128d edge = _mm_loadh_pd(_mm_load_sd(s.column_edges + disk.column + (upwards & 1U)),
                              s.row_edges + disk.row + (upwards >> 1U));
  if (!s.is_periodic) {
    double const r = s.radius_of(i);
    edge = _mm_min_pd(_mm_max_pd(edge, _mm_set1_pd(r)), _mm_set_pd(s.height - r, s.width - r));
  }
  __mmask8 const moves = _mm_cmp_pd_mask(velocity, zero, _CMP_NEQ_OQ);
  __m128d const never = _mm_set1_pd(std::numeric_limits<double>::infinity());
  __m128d const time = _mm_mask_div_pd(never, moves, _mm_sub_pd(edge, place), velocity);
  __m128d const y_time = _mm_unpackhi_pd(time, time);
  // Either is as likely: intrinsics, because a compiler may well make a branch of std::min().
  auto const is_horizontal = static_cast<Index>(_mm_cmp_sd_mask(y_time, time, _CMP_LT_OQ));
  return {_mm_cvtsd_f64(_mm_max_sd(_mm_min_sd(y_time, time), _mm_set_sd(now))), vertical_border + is_horizontal};
}

/// Whether some neighbouring cell lies across the edge of a periodic box.
inline bool is_at_periodic_edge(PredictionInput const& s, MovingDisk const& disk) {
  return s.is_periodic && (static_cast<std::uint32_t>(disk.column - 1) >= static_cast<std::uint32_t>(s.columns - 2) ||
                           static_cast<std::uint32_t>(disk.row - 1) >= static_cast<std::uint32_t>(s.rows - 2));
}

/// The earlier of `best` and the contacts at the times of those lanes that are hits; ties go to the lower Id.
GRIDLOCK_AVX512 inline Prediction earlier_of(Prediction best, __mmask8 hits, __m512d time, Index const* names,
                                             MovingDisk const* disks) {
  __m512d const never = _mm512_set1_pd(std::numeric_limits<double>::infinity());
  double const earliest = _mm512_reduce_min_pd(_mm512_mask_mov_pd(never, hits, time));
  __mmask8 const first = _mm512_mask_cmp_pd_mask(hits, time, _mm512_set1_pd(earliest), _CMP_EQ_OQ);
  unsigned const firsts = first;
  if (((firsts & (firsts - 1U)) != 0) | (earliest == best.time)) [[unlikely]] {
    for (unsigned rest = firsts; rest != 0; rest &= rest - 1U) {
      Index const j = names[std::countr_zero(rest)];
      bool const is_tie = earliest == best.time && best.partner < vertical_border;
      if (earliest < best.time || (is_tie && disks[j].id_index < disks[best.partner].id_index)) best = {earliest, j};
    }
  } else {
    // Which of the two is earlier is a coin toss: no branch may depend on it, or the processor could not begin with
    // the next prediction meanwhile.
    Index const choice[2] = {best.partner, names[std::countr_zero(firsts | 0x80U)]};
    best = {_mm_cvtsd_f64(_mm_min_sd(_mm_set_sd(earliest), _mm_set_sd(best.time))),
            choice[earliest < best.time ? 1 : 0]};
  }
  return best;
}

}  // namespace gridlock::exact

#endif
