#include "engine/exact/growing_candidates.hpp"
#include "engine/exact/prediction.hpp"

// Written once with Google Highway, and compiled once for every target below: this file includes itself. Only headers of Highway are
// used; target() chooses which of the kernels is called. AVX-512 has a kernel by hand (prediction_avx512.cpp), which is 1.5 times as fast.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/exact/prediction_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

// The plain C++ beside is faster than Highway's one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::exact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using gridlock::HWY_NAMESPACE::nearest_image;

namespace {

constexpr std::size_t slots_per_cell = 4;
constexpr std::size_t most_candidates = 9 * slots_per_cell;
constexpr std::size_t most_lanes = 8;

/// The disks around disk i but for i and `apart`, moved together.
struct Candidates {
  alignas(64) Index disks[most_candidates + slots_per_cell];
  std::size_t count = 0;
};

HWY_INLINE void collect(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  hn::FixedTag<Index, slots_per_cell> const cell;
  auto const nobody = hn::Set(cell, no_disk);
  auto const self = hn::Set(cell, i);
  auto const other = hn::Set(cell, apart);
  MovingDisk const& disk = s.disks[i];
  Index const* run = s.slots + static_cast<std::size_t>(disk.row) * s.row_stride +
                     static_cast<std::size_t>(disk.column) * slots_per_cell;
  std::size_t count = 0;
  for (int row = 0; row < 3; ++row, run += s.row_stride) {
    for (std::size_t k = 0; k < 3 * slots_per_cell; k += slots_per_cell) {
      auto const names = hn::LoadU(cell, run + k);
      auto const is_disk = hn::And(hn::Ne(names, nobody), hn::And(hn::Ne(names, self), hn::Ne(names, other)));
      count += hn::CompressStore(names, is_disk, cell, candidates.disks + count);
    }
  }
  candidates.count = count;
}

/// The columns of the candidates, with zeros behind them up to a full register.
struct Columns {
  alignas(64) double x[most_candidates + most_lanes];
  alignas(64) double y[most_candidates + most_lanes];
  alignas(64) double velocity_x[most_candidates + most_lanes];
  alignas(64) double velocity_y[most_candidates + most_lanes];
  alignas(64) double event_time[most_candidates + most_lanes];
  alignas(64) double squared_contact[most_candidates + most_lanes];
  alignas(64) double time[most_candidates + most_lanes];
};

HWY_INLINE void load_columns(PredictionInput const& s, double radius, Candidates const& candidates, std::size_t lanes,
                             Columns& columns) {
  for (std::size_t k = 0; k < candidates.count; ++k) {
    MovingDisk const& disk = s.disks[candidates.disks[k]];
    columns.x[k] = disk.x;
    columns.y[k] = disk.y;
    columns.velocity_x[k] = disk.velocity_x;
    columns.velocity_y[k] = disk.velocity_y;
    columns.event_time[k] = disk.event_time;
    double const contact = radius + s.radius_of(candidates.disks[k]);
    columns.squared_contact[k] = contact * contact;
  }
  for (std::size_t k = candidates.count; k % lanes != 0; ++k) {
    columns.x[k] = columns.y[k] = columns.velocity_x[k] = columns.velocity_y[k] = 0.0;
    columns.event_time[k] = columns.squared_contact[k] = 0.0;
  }
}

/// Whether some neighbouring cell lies across the edge of a periodic box.
HWY_INLINE bool is_at_periodic_edge(PredictionInput const& s, MovingDisk const& disk) {
  return s.is_periodic && (static_cast<std::uint32_t>(disk.column - 1) >= static_cast<std::uint32_t>(s.columns - 2) ||
                           static_cast<std::uint32_t>(disk.row - 1) >= static_cast<std::uint32_t>(s.rows - 2));
}

/// When each of the disks touches; never where it does not before its own event.
HWY_INLINE void find_times(PredictionInput const& s, Index i, double now, std::size_t count, Columns& columns) {
  hn::CappedTag<double, most_lanes> const tag;
  MovingDisk const& self = s.disks[i];
  bool const needs_images = is_at_periodic_edge(s, self);
  auto const zero = hn::Zero(tag);
  auto const never = hn::Set(tag, std::numeric_limits<double>::infinity());
  auto const time_now = hn::Set(tag, now);
  auto const self_x = hn::Set(tag, self.x);
  auto const self_y = hn::Set(tag, self.y);
  auto const self_velocity_x = hn::Set(tag, self.velocity_x);
  auto const self_velocity_y = hn::Set(tag, self.velocity_y);
  for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
    auto const w_x = hn::Sub(hn::Load(tag, columns.velocity_x + k), self_velocity_x);
    auto const w_y = hn::Sub(hn::Load(tag, columns.velocity_y + k), self_velocity_y);
    auto d_x = hn::Add(hn::Sub(hn::Load(tag, columns.x + k), self_x), hn::Mul(w_x, time_now));
    auto d_y = hn::Add(hn::Sub(hn::Load(tag, columns.y + k), self_y), hn::Mul(w_y, time_now));
    if (needs_images) {
      d_x = nearest_image(d_x, s.width);
      d_y = nearest_image(d_y, s.height);
    }
    auto const b = hn::Add(hn::Mul(d_x, w_x), hn::Mul(d_y, w_y));
    auto const c = hn::Sub(hn::Add(hn::Mul(d_x, d_x), hn::Mul(d_y, d_y)), hn::Load(tag, columns.squared_contact + k));
    auto const squared_speed = hn::Add(hn::Mul(w_x, w_x), hn::Mul(w_y, w_y));
    auto const discriminant = hn::Sub(hn::Mul(b, b), hn::Mul(squared_speed, c));
    auto const wait = hn::Div(c, hn::Sub(hn::Sqrt(discriminant), b));
    auto const time = hn::Add(time_now, hn::IfThenElse(hn::Gt(wait, zero), wait, zero));
    auto const meets = hn::And(hn::And(hn::Lt(b, zero), hn::Ge(discriminant, zero)),
                               hn::Lt(time, hn::Load(tag, columns.event_time + k)));
    hn::Store(hn::IfThenElse(meets, time, never), tag, columns.time + k);
  }
}

/// The earlier of `border` and the contacts; ties go to the lower Id.
HWY_INLINE Prediction earliest_of(PredictionInput const& s, Prediction const& border, Candidates const& candidates,
                                  double const* time) {
  // Which one is earlier is a coin toss: no branch may depend on it.
  Prediction best = border;
  bool has_tie = false;
  for (std::size_t k = 0; k < candidates.count; ++k) {
    bool const is_earlier = time[k] < best.time;
    has_tie |= time[k] == best.time;
    best.time = is_earlier ? time[k] : best.time;
    best.partner = is_earlier ? candidates.disks[k] : best.partner;
  }
  if (!has_tie) [[likely]]
    return best;
  best = border;
  for (std::size_t k = 0; k < candidates.count; ++k) {
    Index const j = candidates.disks[k];
    bool const is_tie = time[k] == best.time && best.partner < vertical_border;
    if (time[k] < best.time || (is_tie && s.disks[j].id_index < s.disks[best.partner].id_index)) best = {time[k], j};
  }
  return best;
}

HWY_INLINE Prediction predict_collected(PredictionInput const& s, Index i, double now, Candidates const& candidates) {
  Columns columns;
  hn::CappedTag<double, most_lanes> const tag;
  load_columns(s, s.radius_of(i), candidates, hn::Lanes(tag), columns);
  find_times(s, i, now, candidates.count, columns);
  return earliest_of(s, predict_border(s, i, now), candidates, columns.time);
}

/// What grows of the candidates: when the velocity of one of each two last changed, and the sum of their radii at scale 1.
struct GrowingColumns {
  alignas(64) double begin[most_candidates + most_lanes];
  alignas(64) double radii[most_candidates + most_lanes];
};

HWY_INLINE void load_growing_columns(PredictionInput const& s, Index i, Candidates const& candidates, std::size_t lanes,
                                     GrowingColumns& columns) {
  double const radius = s.radius[i];
  double const last_hit = s.last_hit[i];
  for (std::size_t k = 0; k < candidates.count; ++k) {
    Index const j = candidates.disks[k];
    columns.begin[k] = std::max(last_hit, s.last_hit[j]);
    columns.radii[k] = radius + s.radius[j];
  }
  for (std::size_t k = candidates.count; k % lanes != 0; ++k) columns.begin[k] = columns.radii[k] = 0.0;
}

/// By how much a coordinate of a separation is to be moved to be the nearest image.
template <class V>
HWY_INLINE V shifts_to_nearest(V d, double side) {
  hn::DFromV<V> const tag;
  V const down = hn::IfThenElseZero(hn::Gt(d, hn::Set(tag, 0.5 * side)), hn::Set(tag, -side));
  return hn::IfThenElse(hn::Lt(d, hn::Set(tag, -0.5 * side)), hn::Set(tag, side), down);
}

/// The same as find_times() for disks that grow. Returns whether some part so slowly that growth can overtake them.
HWY_INLINE bool find_growing_times(PredictionInput const& s, Index i, double now, std::size_t count,
                                   GrowingColumns const& growing, Columns& columns) {
  hn::CappedTag<double, most_lanes> const tag;
  MovingDisk const& self = s.disks[i];
  bool const needs_images = is_at_periodic_edge(s, self);
  auto const zero = hn::Zero(tag);
  auto const never = hn::Set(tag, std::numeric_limits<double>::infinity());
  auto const time_now = hn::Set(tag, now);
  auto const rate = hn::Set(tag, s.scale.rate);
  auto is_slow = hn::Lt(zero, zero);
  for (std::size_t k = 0; k < count; k += hn::Lanes(tag)) {
    auto const begin = hn::Load(tag, growing.begin + k);
    auto const w_x = hn::Sub(hn::Load(tag, columns.velocity_x + k), hn::Set(tag, self.velocity_x));
    auto const w_y = hn::Sub(hn::Load(tag, columns.velocity_y + k), hn::Set(tag, self.velocity_y));
    auto d_x = hn::Sub(hn::Load(tag, columns.x + k), hn::Set(tag, self.x));
    auto d_y = hn::Sub(hn::Load(tag, columns.y + k), hn::Set(tag, self.y));
    if (needs_images) {
      d_x = hn::Add(d_x, shifts_to_nearest(hn::Add(d_x, hn::Mul(w_x, time_now)), s.width));
      d_y = hn::Add(d_y, shifts_to_nearest(hn::Add(d_y, hn::Mul(w_y, time_now)), s.height));
    }
    d_x = hn::Add(d_x, hn::Mul(w_x, begin));
    d_y = hn::Add(d_y, hn::Mul(w_y, begin));
    auto const radii = hn::Load(tag, growing.radii + k);
    auto const scale =
        hn::Add(hn::Set(tag, s.scale.at_zero), hn::Add(hn::Set(tag, s.scale.rest), hn::Mul(rate, begin)));
    auto const contact = hn::Mul(radii, scale);
    auto const growth = hn::Mul(radii, rate);
    auto const a = hn::Sub(hn::Add(hn::Mul(w_x, w_x), hn::Mul(w_y, w_y)), hn::Mul(growth, growth));
    auto const b = hn::Sub(hn::Add(hn::Mul(d_x, w_x), hn::Mul(d_y, w_y)), hn::Mul(growth, contact));
    auto const c = hn::Sub(hn::Add(hn::Mul(d_x, d_x), hn::Mul(d_y, d_y)), hn::Mul(contact, contact));
    auto const discriminant = hn::Sub(hn::Mul(b, b), hn::Mul(a, c));
    auto const due = hn::Add(begin, hn::Div(c, hn::Sub(hn::Sqrt(discriminant), b)));
    auto const time = hn::IfThenElse(hn::Gt(due, time_now), due, time_now);
    auto const meets = hn::And(hn::And(hn::Lt(b, zero), hn::Ge(discriminant, zero)),
                               hn::Lt(time, hn::Load(tag, columns.event_time + k)));
    hn::Store(hn::IfThenElse(meets, time, never), tag, columns.time + k);
    is_slow = hn::Or(is_slow, hn::Lt(a, zero));
  }
  return !hn::AllFalse(tag, is_slow);
}

/// The first of the border and the contacts of a disk that grows; `apart` is no candidate.
HWY_INLINE Prediction predict_growing_collected(PredictionInput const& s, Index i, double now, Index apart,
                                                Candidates const& candidates) {
  Columns columns;
  GrowingColumns growing;
  hn::CappedTag<double, most_lanes> const tag;
  load_columns(s, s.radius[i], candidates, hn::Lanes(tag), columns);
  load_growing_columns(s, i, candidates, hn::Lanes(tag), growing);
  bool const has_slow_ones = find_growing_times(s, i, now, candidates.count, growing, columns);
  Prediction best = earliest_of(s, border_growing(s, i, now), candidates, columns.time);
  if (has_slow_ones) [[unlikely]] {
    EarliestGrowing earliest(s, i, now, no_disk, best);
    for (std::size_t k = 0; k < candidates.count; ++k) earliest.consider_nearest_image(candidates.disks[k]);
    best = earliest.best();
  }
  return apart == no_disk ? best : with_disk_apart(s, i, now, apart, best);
}

/// The disks that i may meet but for `apart`: those of its list where it has one, or of the cells around it.
/// Returns false where the cells have other slots.
HWY_INLINE bool collect_growing(PredictionInput const& s, Index i, Index apart, Candidates& candidates) {
  if (s.neighbours == nullptr || !s.neighbours[i].has_all()) {
    if (s.capacity != slots_per_cell) return false;
    collect(s, i, apart, candidates);
    return true;
  }
  Neighbours const& list = s.neighbours[i];
  std::size_t count = 0;
  for (std::uint32_t k = 0; k < list.count; ++k) {
    candidates.disks[count] = list.disks[k];
    count += list.disks[k] != apart ? 1 : 0;
  }
  candidates.count = count;
  return true;
}

}  // namespace

Prediction predict(PredictionInput const& s, Index i, double now, Index apart) {
  Candidates candidates;
  collect(s, i, apart, candidates);
  return predict_collected(s, i, now, candidates);
}

PairPrediction predict_pair(PredictionInput const& s, Index i, Index j, double now) {
  Candidates around_i;
  Candidates around_j;
  collect(s, i, j, around_i);
  collect(s, j, i, around_j);
  return {predict_collected(s, i, now, around_i), predict_collected(s, j, now, around_j)};
}

Prediction predict_growing(PredictionInput const& s, Index i, double now, Index apart) {
  Candidates candidates;
  if (!collect_growing(s, i, apart, candidates)) [[unlikely]]
    return exact::predict_growing(s, i, now, apart);
  return predict_growing_collected(s, i, now, apart, candidates);
}

PairPrediction predict_pair_growing(PredictionInput const& s, Index i, Index j, double now) {
  Candidates around_i;
  Candidates around_j;
  if (!collect_growing(s, i, j, around_i) || !collect_growing(s, j, i, around_j)) [[unlikely]]
    return exact::predict_pair_growing(s, i, j, now);
  return {predict_growing_collected(s, i, now, j, around_i), predict_growing_collected(s, j, now, i, around_j)};
}

constexpr Predictor constant{predict, predict_pair};
constexpr Predictor growing{predict_growing, predict_pair_growing};

}  // namespace gridlock::exact::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock::exact {

std::optional<Predictor> highway_predictor(Target target, bool is_growing) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return is_growing ? N_SSE4::growing : N_SSE4::constant;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return is_growing ? N_AVX2::growing : N_AVX2::constant;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return is_growing ? N_NEON::growing : N_NEON::constant;
#endif
  return std::nullopt;
}

}  // namespace gridlock::exact

#endif
