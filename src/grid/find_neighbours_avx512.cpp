#include "core/avx512.hpp"
#include "grid/find_neighbours_kernels.hpp"

// Written by hand, because one instruction moves the kept lanes together: Highway takes 1.2 times as long.

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>

namespace gridlock {

namespace {

constexpr std::size_t lanes = 8;
static_assert(neighbour_slack >= lanes);

template <bool has_images>
GRIDLOCK_AVX512 inline std::size_t find(RowSearch const& search, std::span<RowRange const> ranges,
                                        std::uint32_t* found) {
  __m512d const x = _mm512_set1_pd(search.p.x);
  __m512d const y = _mm512_set1_pd(search.p.y);
  __m512d const squared_cutoff = _mm512_set1_pd(search.squared_cutoff);
  __m256i const left_out = _mm256_set1_epi32(static_cast<int>(search.left_out));
  __m256i const zero_to_seven = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  std::uint32_t* top = found;
  for (RowRange const& range : ranges) {
    for (std::size_t row = range.first; row < range.end; row += lanes) {
      auto const lanes_taken = static_cast<unsigned>(std::min(lanes, range.end - row));
      auto const taken = static_cast<__mmask8>((1U << lanes_taken) - 1U);
      __m512d d_x = _mm512_sub_pd(_mm512_maskz_loadu_pd(taken, search.x + row), x);
      __m512d d_y = _mm512_sub_pd(_mm512_maskz_loadu_pd(taken, search.y + row), y);
      if constexpr (has_images) {
        d_x = nearest_image(d_x, search.box->period_x());
        d_y = nearest_image(d_y, search.box->period_y());
      }
      __m512d const squared_distance = _mm512_add_pd(_mm512_mul_pd(d_x, d_x), _mm512_mul_pd(d_y, d_y));
      __m256i const rows = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(row)), zero_to_seven);
      __mmask8 const is_other = _mm256_mask_cmpneq_epi32_mask(taken, rows, left_out);
      __mmask8 const is_near = _mm512_mask_cmp_pd_mask(is_other, squared_distance, squared_cutoff, _CMP_LT_OQ);
      // Kept lanes are moved together and written as a whole register: writing single lanes takes ten times as long.
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(top), _mm256_maskz_compress_epi32(is_near, rows));
      top += std::popcount(static_cast<unsigned>(is_near));
    }
  }
  return static_cast<std::size_t>(top - found);
}

GRIDLOCK_AVX512 std::size_t find_neighbours_avx512(RowSearch const& search, std::span<RowRange const> ranges,
                                                   std::uint32_t* found) {
  if (search.box == nullptr || !search.box->has_images()) return find<false>(search, ranges, found);
  return find<true>(search, ranges, found);
}

}  // namespace

FindNeighbours find_neighbours_with_avx512(Target target) {
  return target == Target::avx512 ? find_neighbours_avx512 : nullptr;
}

}  // namespace gridlock

#else

namespace gridlock {

FindNeighbours find_neighbours_with_avx512(Target) { return nullptr; }

}  // namespace gridlock

#endif
