#include "core/avx512.hpp"
#include "engine/exact/near_places.hpp"

// These kernels are written by hand for AVX-512 alone: narrower registers lack the instruction that moves the kept
// lanes together, and would gain no time.

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <bit>

namespace gridlock::exact {

namespace {

constexpr std::size_t lanes = 8;
static_assert(names_per_batch == 2 * lanes);

/// Returns a mask of the first `count` lanes, or of all lanes if there are fewer.
template <class Mask>
Mask first_lanes(std::size_t count) {
  constexpr std::size_t all = 8 * sizeof(Mask);
  return static_cast<Mask>((std::uint64_t{1} << std::min(count, all)) - 1U);
}

// Kept lanes are moved together in a register, which is then written whole: writing some lanes takes ten times as long.

GRIDLOCK_AVX512 std::size_t collect(Index const* slots, std::size_t count, Index apart, Index* names) {
  __m512i const nobody = _mm512_set1_epi32(static_cast<int>(no_disk));
  __m512i const other = _mm512_set1_epi32(static_cast<int>(apart));
  std::size_t found = 0;
  for (std::size_t k = 0; k < count; k += names_per_batch) {
    __m512i const here = _mm512_loadu_si512(slots + k);
    __mmask16 kept = _mm512_mask_cmpneq_epi32_mask(first_lanes<__mmask16>(count - k), here, nobody);
    kept = _mm512_mask_cmpneq_epi32_mask(kept, here, other);
    _mm512_storeu_si512(names + found, _mm512_maskz_compress_epi32(kept, here));
    found += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(kept)));
  }
  return found;
}

GRIDLOCK_AVX512 inline __m512d side_by_side(__m128d a, __m128d b, __m128d c, __m128d d) {
  __m256d const low = _mm256_insertf128_pd(_mm256_castpd128_pd256(a), b, 1);
  __m256d const high = _mm256_insertf128_pd(_mm256_castpd128_pd256(c), d, 1);
  return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
}

/// Returns the distance of two places in one direction minus the rooms of both.
GRIDLOCK_AVX512 inline __m512d gap(__m512d other, double own, double period, PlacesAround const& around) {
  __m512d distance = _mm512_abs_pd(_mm512_sub_pd(other, _mm512_set1_pd(own)));
  if (around.has_images) {
    distance = _mm512_min_pd(distance, _mm512_abs_pd(_mm512_sub_pd(_mm512_set1_pd(period), distance)));
  }
  return _mm512_max_pd(_mm512_sub_pd(distance, _mm512_set1_pd(around.rooms)), _mm512_setzero_pd());
}

GRIDLOCK_AVX512 std::size_t keep(PlacesAround const& around, Index* names, std::size_t count) {
  // Lanes behind the last index get the first index; they are not counted.
  std::fill_n(names + count, lanes, names[0]);
  __m512d const own_radius = _mm512_set1_pd(around.own_radius);
  std::size_t near = 0;
  for (std::size_t k = 0; k < count; k += lanes) {
    Index const* const eight = names + k;
    // Singly loaded, because a gather takes longer.
    auto const place = [&](int n) GRIDLOCK_AVX512 { return _mm_loadu_pd(&around.places[eight[n]].x); };
    auto const radii = [&](int n) GRIDLOCK_AVX512 {
      return _mm_loadh_pd(_mm_load_sd(around.radius + eight[n]), around.radius + eight[n + 1]);
    };
    __m512d const even = side_by_side(place(0), place(2), place(4), place(6));
    __m512d const odd = side_by_side(place(1), place(3), place(5), place(7));
    __m512d const gap_x = gap(_mm512_unpacklo_pd(even, odd), around.place.x, around.period_x, around);
    __m512d const gap_y = gap(_mm512_unpackhi_pd(even, odd), around.place.y, around.period_y, around);
    __m512d const radius = around.radius == nullptr ? own_radius : side_by_side(radii(0), radii(2), radii(4), radii(6));
    __m512d const contact = _mm512_mul_pd(_mm512_add_pd(own_radius, radius), _mm512_set1_pd(around.scale));
    __m512d const squared_gap = _mm512_add_pd(_mm512_mul_pd(gap_x, gap_x), _mm512_mul_pd(gap_y, gap_y));
    __mmask8 const kept = _mm512_mask_cmp_pd_mask(first_lanes<__mmask8>(count - k), squared_gap,
                                                  _mm512_mul_pd(contact, contact), _CMP_LE_OQ);
    __m256i const all = _mm256_loadu_si256(reinterpret_cast<__m256i const*>(eight));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(names + near), _mm256_maskz_compress_epi32(kept, all));
    near += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(kept)));
  }
  return near;
}

}  // namespace

std::optional<NearPlaces> near_places_with_avx512() { return NearPlaces{collect, keep}; }

}  // namespace gridlock::exact

#else

namespace gridlock::exact {

std::optional<NearPlaces> near_places_with_avx512() { return std::nullopt; }

}  // namespace gridlock::exact

#endif
