#pragma once

#include <array>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gridlock {

/// Four floats that one instruction adds, multiplies or compares on every 64-bit processor.
///
/// The operations are those of IEEE 754, so that a processor without such instructions gives the same bits.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

/// Read and write four numbers at once: a processor stalls if it reads all four after a write of one.
inline Float4 load(std::array<float, 4> const& values) { return *reinterpret_cast<Float4 const*>(values.data()); }
inline void store(std::array<float, 4>& values, Float4 v) { *reinterpret_cast<Float4*>(values.data()) = v; }

inline Float4 broadcast(float value) { return Float4{value, value, value, value}; }

/// Returns `v` with `value` in lane 0 … 3.
inline Float4 with_lane(Float4 v, unsigned lane, float value) {
  Int4 const chosen = Int4{0, 1, 2, 3} == static_cast<int>(lane);
  return chosen ? broadcast(value) : v;
}

/// Returns bits of which bit k is set if lane k of a comparison is true.
inline unsigned bits_of(Int4 comparison) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison)));
#else
  return (comparison[0] & 1U) | (comparison[1] & 2U) | (comparison[2] & 4U) | (comparison[3] & 8U);
#endif
}

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

}  // namespace gridlock
