#include "engine/exact/candidates.hpp"
#include "engine/exact/earliest_contact.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; predictor_for() chooses the kernel. AVX-512 has a kernel written by hand
// (prediction_avx512.cpp), which is 1.2 to 1.3 times as fast; with SSSE3 the plain C++ (prediction_plain.cpp) is
// faster. SVE is left out: its registers have no fixed size, so no struct can hold them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/exact/prediction_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::exact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using gridlock::HWY_NAMESPACE::bits_of;
using gridlock::HWY_NAMESPACE::store_together;

namespace {

using Numbers = hn::CappedTag<double, batch>;
using Vec = hn::Vec<Numbers>;
using Two = hn::FixedTag<double, 2>;

/// Collects the candidates of disk i, without `apart`. Returns false where there may be too many.
HWY_INLINE bool collect(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  hn::FixedTag<Index, slots_per_cell> const cell;
  auto const other = hn::Set(cell, apart);
  if (s.neighbours != nullptr) {
    Neighbours const& list = s.neighbours[i];
    auto const nobody = hn::Set(cell, s.nobody);
    for (std::size_t k = 0; k < 16; k += slots_per_cell) {
      auto const names = hn::Load(cell, list.disks + k);
      hn::Store(hn::IfThenElse(hn::Eq(names, other), nobody, names), cell, candidates.disks + k);
    }
    candidates.disks[Neighbours::most] = s.nobody;  // this lane is not an index but the number of neighbours
    candidates.count = list.count;
    return list.has_all();
  }
  if (s.capacity != slots_per_cell) [[unlikely]]
    return false;
  auto const empty = hn::Set(cell, no_disk);
  auto const self = hn::Set(cell, i);
  Index const* run = first_slot_around(s, i);
  std::size_t count = 0;
  for (int row = 0; row < 3; ++row, run += s.row_stride) {
    for (std::size_t k = 0; k < 3 * slots_per_cell; k += slots_per_cell) {
      auto const names = hn::LoadU(cell, run + k);
      auto const is_candidate = hn::And(hn::Ne(names, empty), hn::And(hn::Ne(names, self), hn::Ne(names, other)));
      count += store_together(names, is_candidate, candidates.disks + count);
    }
  }
  candidates.count = count;
  auto const nobody = hn::Set(cell, s.nobody);
  for (std::size_t k = 0; k < batch; k += slots_per_cell) hn::StoreU(nobody, cell, candidates.disks + count + k);
  return true;
}

HWY_INLINE hn::Vec<Two> side_by_side(double const* low, double const* high) {
  return hn::InterleaveLower(Two(), hn::Set(Two(), *low), hn::Set(Two(), *high));
}

/// Returns one quantity of each disk of a register.
template <class NumberOf>
HWY_INLINE Vec numbers_of(Index const* names, NumberOf number_of) {
#if HWY_TARGET == HWY_AVX2
  return hn::Combine(Numbers(), side_by_side(number_of(names[2]), number_of(names[3])),
                     side_by_side(number_of(names[0]), number_of(names[1])));
#else
  return side_by_side(number_of(names[0]), number_of(names[1]));
#endif
}

/// Quantities of the disks of a batch, one register each, transposed from one cache line for a disk.
struct Columns {
  Vec x, y, velocity_x, velocity_y, event_time, last_hit;
};

HWY_INLINE Columns columns_of(MovingDisk const* disks, Index const* names) {
  Numbers const tag;
#if HWY_TARGET == HWY_AVX2
  auto const motion = [&](int k) HWY_ATTR { return hn::Load(tag, &disks[names[k]].x); };
  auto const times = [&](int low, int high) HWY_ATTR {
    return hn::Combine(tag, hn::Load(Two(), &disks[names[high]].event_time),
                       hn::Load(Two(), &disks[names[low]].event_time));
  };
  Vec const m0 = motion(0);
  Vec const m1 = motion(1);
  Vec const m2 = motion(2);
  Vec const m3 = motion(3);
  Vec const x_01 = hn::InterleaveLower(tag, m0, m1);  // x of disks 0 and 1, then their vx
  Vec const x_23 = hn::InterleaveLower(tag, m2, m3);
  Vec const y_01 = hn::InterleaveUpper(tag, m0, m1);
  Vec const y_23 = hn::InterleaveUpper(tag, m2, m3);
  Vec const t_02 = times(0, 2);
  Vec const t_13 = times(1, 3);
  return {hn::ConcatLowerLower(tag, x_23, x_01), hn::ConcatLowerLower(tag, y_23, y_01),
          hn::ConcatUpperUpper(tag, x_23, x_01), hn::ConcatUpperUpper(tag, y_23, y_01),
          hn::InterleaveLower(tag, t_02, t_13),  hn::InterleaveUpper(tag, t_02, t_13)};
#else
  MovingDisk const& a = disks[names[0]];
  MovingDisk const& b = disks[names[1]];
  Vec const place_a = hn::Load(tag, &a.x);
  Vec const place_b = hn::Load(tag, &b.x);
  Vec const velocity_a = hn::Load(tag, &a.velocity_x);
  Vec const velocity_b = hn::Load(tag, &b.velocity_x);
  Vec const time_a = hn::Load(tag, &a.event_time);
  Vec const time_b = hn::Load(tag, &b.event_time);
  return {hn::InterleaveLower(tag, place_a, place_b),       hn::InterleaveUpper(tag, place_a, place_b),
          hn::InterleaveLower(tag, velocity_a, velocity_b), hn::InterleaveUpper(tag, velocity_a, velocity_b),
          hn::InterleaveLower(tag, time_a, time_b),         hn::InterleaveUpper(tag, time_a, time_b)};
#endif
}

/// Returns the shifts by which the nearest images are away, for separations that are d along an axis of this side.
HWY_INLINE Vec shifts_to_nearest(Vec d, double side, double by) {
  Numbers const tag;
  Vec const down = hn::IfThenElseZero(hn::Gt(d, hn::Set(tag, 0.5 * side)), hn::Set(tag, -by));
  return hn::IfThenElse(hn::Lt(d, hn::Set(tag, -0.5 * side)), hn::Set(tag, by), down);
}

/// Returns the shifts of coordinates of separations that lead to the nearest images.
HWY_INLINE Vec shifts_to_nearest(Vec d, double side) { return shifts_to_nearest(d, side, side); }

/// Returns x of the separations from the nearest images in an oblique box, which are (now_x, now_y) now.
HWY_INLINE Vec nearest_in_oblique(PredictionInput const& s, Vec d_x, Vec now_x, Vec now_y) {
  Vec const lean = shifts_to_nearest(now_y, s.period_y, s.lean);
  return hn::Add(d_x, hn::Add(lean, shifts_to_nearest(hn::Add(now_x, lean), s.period_x)));
}

/// The quantities that all candidates of a disk share.
struct Self {
  MovingDisk const& disk;
  double now;
  double radius;
  bool needs_images;
};

/// Returns for each disk of a register the time of contact, or `never` where there is none before its own event. Sets
/// `has_slow_ones` where a disk parts so slowly that growth can overtake the pair.
template <bool grows>
HWY_INLINE Vec times_of(PredictionInput const& s, Self const& self, Index const* names, bool& has_slow_ones) {
  Numbers const tag;
  Vec const zero = hn::Zero(tag);
  Vec const infinite = hn::Set(tag, std::numeric_limits<double>::infinity());
  Vec const time_now = hn::Set(tag, self.now);
  Columns const other = columns_of(s.disks, names);
  Vec const begin = hn::Max(hn::Set(tag, self.disk.last_hit), other.last_hit);
  Vec const w_x = hn::Sub(other.velocity_x, hn::Set(tag, self.disk.velocity_x));
  Vec const w_y = hn::Sub(other.velocity_y, hn::Set(tag, self.disk.velocity_y));
  Vec d_x = hn::Sub(other.x, hn::Set(tag, self.disk.x));
  Vec d_y = hn::Sub(other.y, hn::Set(tag, self.disk.y));
  if (self.needs_images) {
    Vec const now_x = hn::Add(d_x, hn::Mul(w_x, time_now));
    Vec const now_y = hn::Add(d_y, hn::Mul(w_y, time_now));
    d_x = s.lean == 0.0 ? hn::Add(d_x, shifts_to_nearest(now_x, s.period_x)) : nearest_in_oblique(s, d_x, now_x, now_y);
    d_y = hn::Add(d_y, shifts_to_nearest(now_y, s.period_y));
  }
  d_x = hn::Add(d_x, hn::Mul(w_x, begin));
  d_y = hn::Add(d_y, hn::Mul(w_y, begin));
  Vec contact = hn::Set(tag, self.radius + self.radius);
  if (s.radius != nullptr) {
    contact = hn::Add(hn::Set(tag, self.radius), numbers_of(names, [&](Index j) HWY_ATTR { return s.radius + j; }));
  }
  Vec a = hn::Add(hn::Mul(w_x, w_x), hn::Mul(w_y, w_y));
  Vec b = hn::Add(hn::Mul(d_x, w_x), hn::Mul(d_y, w_y));
  if constexpr (grows) {
    Vec const rate = hn::Set(tag, s.scale.rate);
    Vec const growth = hn::Mul(contact, rate);
    contact = hn::Mul(
        contact, hn::Add(hn::Set(tag, s.scale.at_zero), hn::Add(hn::Set(tag, s.scale.rest), hn::Mul(rate, begin))));
    a = hn::Sub(a, hn::Mul(growth, growth));
    b = hn::Sub(b, hn::Mul(growth, contact));
    has_slow_ones |= !hn::AllFalse(tag, hn::Lt(a, zero));
  }
  Vec const squared_contact = hn::Mul(contact, contact);
  Vec const c = hn::Sub(hn::Add(hn::Mul(d_x, d_x), hn::Mul(d_y, d_y)), squared_contact);
  Vec const across = hn::Sub(hn::Mul(d_x, w_y), hn::Mul(d_y, w_x));
  Vec const discriminant =
      grows ? hn::Sub(hn::Mul(b, b), hn::Mul(a, c)) : hn::Sub(hn::Mul(a, squared_contact), hn::Mul(across, across));
  Vec const due = hn::Add(begin, hn::Div(c, hn::Sub(hn::Sqrt(discriminant), b)));
  Vec const time = hn::IfThenElse(hn::Gt(due, time_now), due, time_now);
  auto const meets = hn::And(hn::And(hn::Lt(b, zero), hn::Ge(discriminant, zero)), hn::Lt(time, other.event_time));
  return hn::IfThenElse(meets, time, infinite);
}

/// Returns the first event among `best` and the contacts with the candidates.
template <bool grows>
HWY_INLINE Prediction earliest_of(PredictionInput const& s, Index i, double now, Candidates const& candidates,
                                  Prediction best) {
  Numbers const tag;
  constexpr std::size_t lanes = hn::MaxLanes(tag);
  constexpr std::size_t registers = batch / lanes;
  static_assert(registers == 2 || registers == 4);
  Self const self{s.disks[i], now, s.radius_of(i), s.needs_images(i)};
  bool has_slow_ones = false;
  for (std::size_t k = 0; k < candidates.count; k += batch) {
    Index const* const names = candidates.disks + k;
    Vec times[registers];
    for (std::size_t r = 0; r < registers; ++r) times[r] = times_of<grows>(s, self, names + r * lanes, has_slow_ones);
    Vec first = hn::Min(times[0], times[1]);
    if constexpr (registers == 4) first = hn::Min(first, hn::Min(times[2], times[3]));
    Vec const earliest = hn::MinOfLanes(tag, first);
    unsigned firsts = 0;
    for (std::size_t r = 0; r < registers; ++r) firsts |= bits_of(tag, hn::Eq(times[r], earliest)) << (r * lanes);
    double const time = hn::GetLane(earliest);
    best = earlier_of(best, time, time < std::numeric_limits<double>::infinity() ? firsts : 0, names, s.disks);
  }
  if (has_slow_ones) [[unlikely]]
    best = with_slow_ones(s, i, now, candidates.disks, candidates.count, best);
  return best;
}

/// Predicts for disk i, which has just collided with `apart`.
template <bool grows>
HWY_INLINE Prediction predict_beside(PredictionInput const& s, Index i, double now, Index apart,
                                     Candidates const& candidates) {
  Prediction const best = earliest_of<grows>(s, i, now, candidates, predict_any_border<grows>(s, i, now));
  return grows ? with_disk_apart(s, i, now, apart, best) : best;
}

/// Predicts for a disk with many candidates. `apart` is the disk it has just collided with, or no_disk.
template <bool grows>
Prediction predict_among_many(PredictionInput const& s, Index i, double now, Index apart) {
  Prediction const best = earliest_of_many(s, i, apart, predict_any_border<grows>(s, i, now),
                                           [&](Candidates const& part, Prediction const& first)
                                               HWY_ATTR { return earliest_of<grows>(s, i, now, part, first); });
  return grows && apart != no_disk ? with_disk_apart(s, i, now, apart, best) : best;
}

template <bool grows>
Prediction predict(PredictionInput const& s, Index i, double now) {
  Candidates candidates;
  if (!collect(s, i, no_disk, candidates)) [[unlikely]]
    return predict_among_many<grows>(s, i, now, no_disk);
  return earliest_of<grows>(s, i, now, candidates, predict_any_border<grows>(s, i, now));
}

template <bool grows>
PairPrediction predict_pair(PredictionInput const& s, Index i, Index j, double now) {
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

Predictor predictor(bool is_growing) {
  return is_growing ? Predictor{predict<true>, predict_pair<true>} : Predictor{predict<false>, predict_pair<false>};
}

}  // namespace gridlock::exact::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock::exact {

std::optional<Predictor> highway_predictor([[maybe_unused]] Target target, [[maybe_unused]] bool is_growing) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::predictor(is_growing);
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::predictor(is_growing);
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::predictor(is_growing);
#endif
  return std::nullopt;
}

}  // namespace gridlock::exact

#endif
