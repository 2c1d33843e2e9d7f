#include "core/avx512.hpp"
#include "model/near_rows_ways.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>

namespace gridlock {

namespace {

constexpr std::size_t lanes = 8;
static_assert(near_rows_slack >= lanes);

template <bool has_images>
GRIDLOCK_AVX512 inline std::size_t find(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                        std::uint32_t* found) {
  __m512d const x = _mm512_set1_pd(search.p.x);
  __m512d const y = _mm512_set1_pd(search.p.y);
  __m512d const squared_reach = _mm512_set1_pd(search.squared_reach);
  __m256i const left_out = _mm256_set1_epi32(static_cast<int>(search.left_out));
  __m256i const zero_to_seven = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  std::uint32_t* top = found;
  for (Stretch const& stretch : stretches) {
    for (std::size_t row = stretch.first; row < stretch.end; row += lanes) {
      auto const lanes_taken = static_cast<unsigned>(std::min(lanes, stretch.end - row));
      auto const taken = static_cast<__mmask8>((1U << lanes_taken) - 1U);
      __m512d d_x = _mm512_sub_pd(_mm512_maskz_loadu_pd(taken, search.x + row), x);
      __m512d d_y = _mm512_sub_pd(_mm512_maskz_loadu_pd(taken, search.y + row), y);
      if constexpr (has_images) {
        d_x = nearest_image(d_x, search.box->width());
        d_y = nearest_image(d_y, search.box->height());
      }
      __m512d const squared_distance = _mm512_add_pd(_mm512_mul_pd(d_x, d_x), _mm512_mul_pd(d_y, d_y));
      __m256i const rows = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(row)), zero_to_seven);
      __mmask8 const is_other = _mm256_mask_cmpneq_epi32_mask(taken, rows, left_out);
      __mmask8 const is_near = _mm512_mask_cmp_pd_mask(is_other, squared_distance, squared_reach, _CMP_LT_OQ);
      // Moved together in a register and written whole: writing only some of the lanes takes ten times as long.
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(top), _mm256_maskz_compress_epi32(is_near, rows));
      top += std::popcount(static_cast<unsigned>(is_near));
    }
  }
  return static_cast<std::size_t>(top - found);
}

}  // namespace

bool can_find_near_rows_with_avx512() { return has_avx512(); }

GRIDLOCK_AVX512 std::size_t find_near_rows_with_avx512(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                                       std::uint32_t* found) {
  if (search.box == nullptr || !search.box->is_periodic()) return find<false>(search, stretches, found);
  return find<true>(search, stretches, found);
}

}  // namespace gridlock

#else

namespace gridlock {

bool can_find_near_rows_with_avx512() { return false; }
std::size_t find_near_rows_with_avx512(NearRowsSearch const& search, std::span<Stretch const> stretches,
                                       std::uint32_t* found) {
  return find_near_rows_plainly(search, stretches, found);
}

}  // namespace gridlock

#endif
