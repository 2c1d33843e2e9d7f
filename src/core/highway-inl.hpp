// What the kernels written with Google Highway share. A source that is compiled once for every target includes it inside of its part for
// one target, after <hwy/highway.h>; so the guard lets it through once for each.

#if defined(GRIDLOCK_CORE_HIGHWAY_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#undef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#else
#define GRIDLOCK_CORE_HIGHWAY_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// One component of Box::displacement_inside() in a periodic box.
template <class V>
HWY_INLINE V nearest_image(V d, double side) {
  hn::DFromV<V> const tag;
  V const whole = hn::Set(tag, side);
  V const moved_down = hn::IfThenElse(hn::Gt(d, hn::Set(tag, 0.5 * side)), hn::Sub(d, whole), d);
  return hn::IfThenElse(hn::Lt(d, hn::Set(tag, -0.5 * side)), hn::Add(moved_down, whole), moved_down);
}

/// Bit k is lane k of a mask of at most sixteen lanes.
template <class Tag>
HWY_INLINE unsigned bits_of(Tag tag, hn::Mask<Tag> mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(tag, mask, bytes);
  return static_cast<unsigned>(bytes[0]) | static_cast<unsigned>(bytes[1]) << 8;
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
