#pragma once

#include <array>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace gridlock {

/// Four numbers that are added, multiplied and compared in one instruction on every 64-bit processor.
///
/// The operations are those of IEEE 754, so that a processor without such instructions gives the same bits.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = int __attribute__((vector_size(16)));

/// The four numbers; written and read whole, since reading whole what was just written in part stalls the processor.
inline Float4 load(std::array<float, 4> const& values) { return *reinterpret_cast<Float4 const*>(values.data()); }
inline void store(std::array<float, 4>& values, Float4 v) { *reinterpret_cast<Float4*>(values.data()) = v; }

inline Float4 broadcast(float value) { return Float4{value, value, value, value}; }

/// `v` with the number in one lane, 0 … 3, replaced.
inline Float4 with_lane(Float4 v, unsigned lane, float value) {
  Int4 const chosen = Int4{0, 1, 2, 3} == static_cast<int>(lane);
  return chosen ? broadcast(value) : v;
}

/// Bit k is set where lane k of a comparison is true.
inline unsigned bits_of(Int4 comparison) {
#if defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(comparison)));
#else
  return (comparison[0] & 1U) | (comparison[1] & 2U) | (comparison[2] & 4U) | (comparison[3] & 8U);
#endif
}

}  // namespace gridlock
