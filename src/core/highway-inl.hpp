// Shared by kernels written with Google Highway. A file that is compiled once for every target includes it inside its
// part for one target, after <hwy/highway.h>; so the include guard opens once for each target.

#if defined(GRIDLOCK_CORE_HIGHWAY_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#undef GRIDLOCK_CORE_HIGHWAY_INL_HPP
#else
#define GRIDLOCK_CORE_HIGHWAY_INL_HPP
#endif

#include <hwy/highway.h>

#include <bit>
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

/// The bytes of four 32-bit lanes with those of each mask moved to the front.
struct MovesToFront {
  std::uint8_t bytes[16][16];
};
constexpr MovesToFront moves_to_front() {
  MovesToFront moves{};
  for (unsigned mask = 0; mask < 16; ++mask) {
    std::size_t count = 0;
    for (unsigned lane = 0; lane < 4; ++lane) {
      if ((mask >> lane & 1U) == 0) continue;
      for (unsigned k = 0; k < 4; ++k) moves.bytes[mask][count++] = static_cast<std::uint8_t>(4 * lane + k);
    }
  }
  return moves;
}
alignas(16) inline constexpr MovesToFront to_front = moves_to_front();

/// Stores the lanes of a mask one beside the other, and anything behind them; returns their number. Compilers build the
/// table of hn::CompressStore() anew for each call.
template <class V>
HWY_INLINE std::size_t store_together(V four, hn::Mask<hn::DFromV<V>> mask, std::uint32_t* to) {
  hn::DFromV<V> const tag;
  static_assert(hn::MaxLanes(tag) == 4);
  hn::Repartition<std::uint8_t, decltype(tag)> const as_bytes;
  unsigned const bits = bits_of(tag, mask);
  auto const moved = hn::TableLookupBytes(hn::BitCast(as_bytes, four), hn::Load(as_bytes, to_front.bytes[bits]));
  hn::StoreU(hn::BitCast(tag, moved), tag, to);
  return static_cast<std::size_t>(std::popcount(bits));
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
