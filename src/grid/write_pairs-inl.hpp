// Writes pairs for the kernels written with Google Highway. A file that is compiled once for every target includes it
// inside its part for one target, after <hwy/highway.h>; so the include guard opens once for each target.

#if defined(GRIDLOCK_GRID_WRITE_PAIRS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_GRID_WRITE_PAIRS_INL_HPP
#undef GRIDLOCK_GRID_WRITE_PAIRS_INL_HPP
#else
#define GRIDLOCK_GRID_WRITE_PAIRS_INL_HPP
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "grid/candidate_pairs.hpp"

HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// For each set of bits, the bytes of four agents that make the pairs of the agents whose bits are set. The higher half
/// of a pair is one of the four agents, the lower half is zero.
struct PairBytes {
  static constexpr unsigned others = 4;
  static constexpr std::uint8_t zero = 0x80;
  alignas(32) std::uint8_t of[1U << others][others * sizeof(PairBuffer::Pair)];
};
constexpr PairBytes find_pair_bytes() {
  constexpr unsigned others = PairBytes::others;
  PairBytes bytes{};
  for (unsigned bits = 0; bits < 1U << others; ++bits) {
    std::size_t at = 0;
    for (std::uint8_t other = 0; other < others; ++other) {
      if ((bits >> other & 1U) == 0) continue;
      for (std::uint8_t k = 0; k < 4; ++k) bytes.of[bits][at++] = PairBytes::zero;
      for (std::uint8_t k = 0; k < 4; ++k) bytes.of[bits][at++] = static_cast<std::uint8_t>(4 * other + k);
    }
    while (at < sizeof(bytes.of[bits])) bytes.of[bits][at++] = PairBytes::zero;
  }
  return bytes;
}
constexpr PairBytes pair_bytes = find_pair_bytes();

/// Writes the pairs of an agent with those of four others whose bits are set. Returns the end of the pairs. Four pairs
/// are always written; the caller drops those behind the end.
HWY_INLINE PairBuffer::Pair* write_pairs(std::uint32_t agent, std::uint32_t const* others, unsigned bits,
                                         PairBuffer::Pair* pair) {
  hn::CappedTag<std::uint8_t, sizeof(pair_bytes.of[0])> const tag;
  hn::Repartition<std::uint64_t, decltype(tag)> const pairs_tag;
  auto const first = hn::BitCast(tag, hn::Set(pairs_tag, std::uint64_t{agent}));
  auto const agents = hn::LoadDup128(tag, reinterpret_cast<std::uint8_t const*>(others));
  auto* const to = reinterpret_cast<std::uint8_t*>(pair);
  for (std::size_t k = 0; k < sizeof(pair_bytes.of[0]); k += hn::Lanes(tag)) {
    auto const second = hn::TableLookupBytesOr0(agents, hn::Load(tag, pair_bytes.of[bits] + k));
    hn::StoreU(hn::Or(first, second), tag, to + k);
  }
  return pair + std::popcount(bits);
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
