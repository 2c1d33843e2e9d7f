#include <algorithm>

#include "engine/exact/candidates.hpp"
#include "engine/exact/earliest_contact.hpp"
#include "engine/exact/near_pairs.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel. With AVX-512 that for AVX2 is used. SVE is left out:
// its registers have no fixed size.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/exact/near_pairs_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::exact::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using gridlock::HWY_NAMESPACE::pairs_of;
using gridlock::HWY_NAMESPACE::squared_length;
using gridlock::HWY_NAMESPACE::store_together;
using gridlock::HWY_NAMESPACE::Vectors;

namespace {

using Numbers = hn::CappedTag<double, 4>;
using Vec = hn::Vec<Numbers>;
constexpr std::size_t lanes = hn::MaxLanes(Numbers());

/// Returns the separations, or the relative velocities, of the disks of each pair.
HWY_INLINE Vectors<Numbers> differences(MovingDisk const* disks, double MovingDisk::*first, Index const* one,
                                        Index const* other) {
  double const* from[lanes];
  double const* to[lanes];
  for (std::size_t k = 0; k < lanes; ++k) {
    from[k] = &(disks[one[k]].*first);
    to[k] = &(disks[other[k]].*first);
  }
  Vectors<Numbers> const a = pairs_of(Numbers(), from);
  Vectors<Numbers> const b = pairs_of(Numbers(), to);
  return {hn::Sub(b.x, a.x), hn::Sub(b.y, a.y)};
}

/// Returns the coordinates of separations from the nearest images.
HWY_INLINE Vec nearest(Vec d, double period) {
  Numbers const tag;
  Vec const down = hn::IfThenElseZero(hn::Gt(d, hn::Set(tag, 0.5 * period)), hn::Set(tag, -period));
  return hn::Add(d, hn::IfThenElse(hn::Lt(d, hn::Set(tag, -0.5 * period)), hn::Set(tag, period), down));
}

HWY_INLINE Vec distances_at_contact(PredictionInput const& s, Index const* one, Index const* other) {
  if (s.radius == nullptr) return hn::Set(Numbers(), s.equal_radius + s.equal_radius);
  HWY_ALIGN double sums[lanes];
  for (std::size_t k = 0; k < lanes; ++k) sums[k] = s.radius[one[k]] + s.radius[other[k]];
  return hn::Load(Numbers(), sums);
}

/// Adds the pairs of disk i with the disks after `last` in cells one beside the other, behind the first `count` pairs;
/// returns their new number. As a number with a sign an empty slot is below all disks.
HWY_INLINE std::size_t add_cells(Pairs& pairs, std::size_t count, Index i, Index const* slots, std::size_t cells,
                                 Index last) {
  hn::FixedTag<Index, slots_per_cell> const cell;
  hn::RebindToSigned<decltype(cell)> const with_sign;
  auto const self = hn::Set(cell, i);
  auto const before = hn::BitCast(with_sign, hn::Set(cell, last));
  for (Index const* slot = slots; slot != slots + cells * slots_per_cell; slot += slots_per_cell) {
    auto const names = hn::LoadU(cell, slot);
    auto const is_after = hn::RebindMask(cell, hn::Gt(hn::BitCast(with_sign, names), before));
    hn::StoreU(self, cell, &pairs.one[count]);
    count += store_together(names, is_after, &pairs.other[count]);
  }
  return count;
}

}  // namespace

/// Contract: cells have `slots_per_cell` slots.
Index add(PredictionInput const& s, Index first, Index end, Pairs& pairs) {
  pairs.make_room_for(Pairs::at_once + 5 * slots_per_cell);
  std::size_t count = pairs.count;  // in a register: through memory each cell would wait for the one before
  do {
    Index const* const own = first_slot_around(s, first) + s.row_stride + slots_per_cell;
    count = add_cells(pairs, count, first, own, 1, first);
    count = add_cells(pairs, count, first, own + slots_per_cell, 1, no_disk);
    count = add_cells(pairs, count, first, own + s.row_stride - slots_per_cell, 3, no_disk);
  } while (++first < end && count < Pairs::at_once);
  pairs.count = count;
  return first;
}

void find_times(PredictionInput const& s, Pairs& pairs) {
  Numbers const tag;
  Vec const zero = hn::Zero(tag);
  for (std::size_t k = 0; k < pairs.count; k += lanes) {
    Index const* const one = pairs.one.data() + k;
    Index const* const other = pairs.other.data() + k;
    Vectors<Numbers> d = differences(s.disks, &MovingDisk::x, one, other);
    Vectors<Numbers> const w = differences(s.disks, &MovingDisk::velocity_x, one, other);
    if (s.has_images) d = {nearest(d.x, s.period_x), nearest(d.y, s.period_y)};
    Vec const contact = distances_at_contact(s, one, other);
    Vec const squared_contact = hn::Mul(contact, contact);
    Vec const b = hn::Add(hn::Mul(d.x, w.x), hn::Mul(d.y, w.y));
    Vec const c = hn::Sub(squared_length(d.x, d.y), squared_contact);
    Vec const across = hn::Sub(hn::Mul(d.x, w.y), hn::Mul(d.y, w.x));
    Vec const discriminant = hn::Sub(hn::Mul(squared_length(w.x, w.y), squared_contact), hn::Mul(across, across));
    Vec const due = hn::Div(c, hn::Sub(hn::Sqrt(discriminant), b));
    auto const meets = hn::And(hn::Lt(b, zero), hn::Ge(discriminant, zero));
    Vec const time = hn::IfThenElseZero(hn::Gt(due, zero), due);
    hn::StoreU(hn::IfThenElse(meets, time, hn::Set(tag, never)), tag, pairs.times.data() + k);
  }
}

}  // namespace gridlock::exact::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock::exact {

namespace {

/// Works with any number of slots.
Index add_plain(PredictionInput const& s, Index first, Index end, Pairs& pairs) {
  do {
    pairs.make_room_for(5 * s.capacity);
    Index const* const own = first_slot_around(s, first) + s.row_stride + s.capacity;
    auto const add_slots = [&](Index const* slots, std::size_t cells) {
      for (std::size_t k = 0; k < cells * s.capacity; ++k) pairs.add(first, slots[k], slots[k] != no_disk);
    };
    for (std::size_t k = 0; k < s.capacity; ++k) pairs.add(first, own[k], own[k] > first && own[k] != no_disk);
    add_slots(own + s.capacity, 1);
    add_slots(own + s.row_stride - s.capacity, 3);
  } while (++first < end && pairs.count < Pairs::at_once);
  return first;
}

void find_times_plain(PredictionInput const& s, Pairs& pairs) {
  for (std::size_t k = 0; k < pairs.count; ++k) {
    MovingDisk const& one = s.disks[pairs.one[k]];
    MovingDisk const& other = s.disks[pairs.other[k]];
    double const w_x = other.velocity_x - one.velocity_x;
    double const w_y = other.velocity_y - one.velocity_y;
    double d_x = other.x - one.x;
    double d_y = other.y - one.y;
    d_x += shift_to_nearest(d_x, s.period_x);
    d_y += shift_to_nearest(d_y, s.period_y);
    double const contact = s.radius_of(pairs.one[k]) + s.radius_of(pairs.other[k]);
    double const squared_contact = contact * contact;
    double const b = d_x * w_x + d_y * w_y;
    double const c = (d_x * d_x + d_y * d_y) - squared_contact;
    double const across = d_x * w_y - d_y * w_x;
    double const discriminant = (w_x * w_x + w_y * w_y) * squared_contact - across * across;
    bool const meets = b < 0.0 && discriminant >= 0.0;
    pairs.times[k] = meets ? std::max(0.0, c / (std::sqrt(discriminant) - b)) : never;
  }
}

}  // namespace

NearPairs near_pairs_for([[maybe_unused]] Target target, [[maybe_unused]] PredictionInput const& s) {
  NearPairs kernels{add_plain, find_times_plain};
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) kernels = {N_SSE4::add, N_SSE4::find_times};
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2 || target == Target::avx512) kernels = {N_AVX2::add, N_AVX2::find_times};
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) kernels = {N_NEON::add, N_NEON::find_times};
#endif
  if (s.capacity != slots_per_cell) kernels.add = add_plain;
  return kernels;
}

}  // namespace gridlock::exact

#endif
