// Shared by kernels written with Google Highway. A file that is compiled once for every target includes it inside its
// part for one target, after <hwy/highway.h>; so the include guard opens once for each target.

#if defined(GRIDLOCK_CORE_HIGHWAY_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#undef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#else
#define GRIDLOCK_CORE_HIGHWAY_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Returns one component of Box::displacement_inside() in a periodic box.
template <class V>
HWY_INLINE V nearest_image(V d, double side) {
  hn::DFromV<V> const tag;
  V const whole = hn::Set(tag, side);
  V const moved_down = hn::IfThenElse(hn::Gt(d, hn::Set(tag, 0.5 * side)), hn::Sub(d, whole), d);
  return hn::IfThenElse(hn::Lt(d, hn::Set(tag, -0.5 * side)), hn::Add(moved_down, whole), moved_down);
}

/// Returns the lanes of a mask as bits: bit k is lane k, for up to sixteen lanes.
template <class Tag>
HWY_INLINE unsigned bits_of(Tag tag, hn::Mask<Tag> mask) {
  static_assert(hn::MaxLanes(Tag()) <= 16);
  std::uint8_t bytes[8];
  hn::StoreMaskBits(tag, mask, bytes);
  if constexpr (hn::MaxLanes(Tag()) <= 8) return bytes[0];
  std::uint16_t bits = 0;
  std::memcpy(&bits, bytes, sizeof bits);
  return bits;
}

template <class V>
HWY_INLINE V squared_length(V x, V y) {
  return hn::Add(hn::Mul(x, x), hn::Mul(y, y));
}

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
/// Loads from[0], from[step], from[2 · step] …, `at_once` numbers from each address, into one register.
template <std::size_t at_once, class Tag, class T>
HWY_INLINE hn::Vec<Tag> side_by_side(Tag tag, T const* const* from, std::size_t step = 1) {
  if constexpr (hn::MaxLanes(Tag()) == at_once) {
    return hn::Load(tag, from[0]);
  } else {
    hn::Half<Tag> const half;
    std::size_t const pieces = hn::MaxLanes(half) / at_once;
    return hn::Combine(tag, side_by_side<at_once>(half, from + step * pieces, step),
                       side_by_side<at_once>(half, from, step));
  }
}

template <class D>
struct Vectors {
  hn::Vec<D> x;
  hn::Vec<D> y;
};

/// Loads two numbers that lie side by side in memory, for each disk of a register.
template <class D>
HWY_INLINE Vectors<D> pairs_of(D tag, double const* const* from) {
  auto const even = side_by_side<2>(tag, from, 2);
  auto const odd = side_by_side<2>(tag, from + 1, 2);
  return {hn::InterleaveLower(tag, even, odd), hn::InterleaveUpper(tag, even, odd)};
}
#endif

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
