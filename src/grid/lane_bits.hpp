#pragma once

#include "gridlock/grid/detail/float4.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gridlock {

/// Returns the bits of four comparisons, four bits each, the first comparison lowest.
inline unsigned bits_of(Int4 a, Int4 b, Int4 c, Int4 d) {
#if defined(__SSE2__)
  auto const as_vector = [](Int4 v) { return reinterpret_cast<__m128i>(v); };
  __m128i const low = _mm_packs_epi32(as_vector(a), as_vector(b));
  __m128i const high = _mm_packs_epi32(as_vector(c), as_vector(d));
  return static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(low, high)));
#else
  return bits_of(a) | bits_of(b) << 4 | bits_of(c) << 8 | bits_of(d) << 12;
#endif
}

/// Returns PackedGrid::is_near() as bits.
inline unsigned near_slots(PackedGrid::Block const& block, PackedGrid::LocalPoint p, float limit) {
  return bits_of(PackedGrid::is_near(block, p, limit));
}

}  // namespace gridlock
