#pragma once

#include "gridlock/grid/float4.hpp"
#include "gridlock/grid/packed_grid.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gridlock {

/// Bit k is set where lane k of a comparison is true.
inline unsigned bits_of(Int4 comparison) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison)));
#else
  return (comparison[0] & 1U) | (comparison[1] & 2U) | (comparison[2] & 4U) | (comparison[3] & 8U);
#endif
}

/// bits_of() of four comparisons, four bits each, the first one lowest.
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

/// The slots of a block that may be within the limit of a point seen from the block's cell, as bits.
inline unsigned near_slots(PackedGrid::Block const& block, PackedGrid::LocalPoint p, float limit) {
  return bits_of(PackedGrid::is_near(block, p, limit));
}

}  // namespace gridlock
