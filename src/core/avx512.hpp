#pragma once

// Shared by files with functions for AVX-512. Only functions marked GRIDLOCK_AVX512 use these instructions;
// uses_avx512() decides at run time whether they are called. The file is empty for compilers without such functions.

#if defined(__x86_64__) && defined(__GNUC__)

#include <immintrin.h>

#include "gridlock/core/target.hpp"

#if !defined(__clang__)
// GCC 12 warns wrongly of deliberately undefined registers inside its own intrinsics.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif

#define GRIDLOCK_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl,avx512bw")))

namespace gridlock {

/// Returns whether kernels marked GRIDLOCK_AVX512 are to be used.
inline bool uses_avx512() { return target() == Target::avx512; }

/// Returns one component of Box::displacement_inside() in a periodic box, for eight numbers.
GRIDLOCK_AVX512 inline __m512d nearest_image(__m512d d, double side) {
  __m512d const whole = _mm512_set1_pd(side);
  __mmask8 const above = _mm512_cmp_pd_mask(d, _mm512_set1_pd(0.5 * side), _CMP_GT_OQ);
  __mmask8 const below = _mm512_cmp_pd_mask(d, _mm512_set1_pd(-0.5 * side), _CMP_LT_OQ);
  d = _mm512_mask_sub_pd(d, above, d, whole);
  return _mm512_mask_add_pd(d, below, d, whole);
}

/// Returns four groups of four numbers in one register. Contract: each group is aligned to 16 bytes.
GRIDLOCK_AVX512 inline __m512 fours_side_by_side(float const* a, float const* b, float const* c, float const* d) {
  __m256 const low = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(a)), _mm_load_ps(b), 1);
  __m256 const high = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(c)), _mm_load_ps(d), 1);
  return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}

GRIDLOCK_AVX512 inline __m512 each_four_times(float a, float b, float c, float d) {
  return _mm512_setr_ps(a, a, a, a, b, b, b, b, c, c, c, c, d, d, d, d);
}

}  // namespace gridlock

#endif
