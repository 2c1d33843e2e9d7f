#include "analysis/displacement_sums.hpp"

#include <array>
#include <cstdint>
#include <cstring>

#include "core/avx512.hpp"

namespace gridlock {

namespace {

[[gnu::always_inline]] inline void add_eight(Displacements const& moved, std::size_t k, std::size_t count,
                                             double squared_overlap, Lanes& sums) {
  Eight x0{}, y0{}, x1{}, y1{};
  std::memcpy(&x0, moved.x0 + k, count * sizeof(double));
  std::memcpy(&y0, moved.y0 + k, count * sizeof(double));
  std::memcpy(&x1, moved.x1 + k, count * sizeof(double));
  std::memcpy(&y1, moved.y1 + k, count * sizeof(double));
  Eight const dx = x1 - x0;
  Eight const dy = y1 - y0;
  Eight const squares = dx * dx + dy * dy;
  Eight const one = Eight{} + 1.0;
  sums.squares += squares;
  sums.fourths += squares * squares;
  sums.near += squares <= Eight{} + squared_overlap ? one : Eight{};
}

[[gnu::always_inline]] inline void add_all(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  Lanes sums = lanes;  // a local copy stays in registers
  std::size_t k = 0;
  for (; k + lane_count <= moved.count; k += lane_count) add_eight(moved, k, lane_count, squared_overlap, sums);
  if (std::size_t const rest = moved.count - k; rest > 0) {
    add_eight(moved, k, rest, squared_overlap, sums);
    // Lanes without an agent have counted as an agent that has not moved.
    for (std::size_t l = rest; l < lane_count; ++l) sums.near[l] -= 1.0;
  }
  lanes = sums;
}

/// Adds J₀(q |Δr|) of agents from `first` on, with the same bits as add_scattering_avx512().
void add_scattering_from(std::size_t first, Displacements const& moved, double squared_q, BesselTable const& table,
                         Eight& sums) {
  for (std::size_t k = first; k < moved.count; ++k) sums[k % lane_count] += table(squared_q * moved.squared(k));
}

void add_scattering_scalar(Displacements const& moved, double squared_q, BesselTable const& table, Eight& sums) {
  add_scattering_from(0, moved, squared_q, table, sums);
}

void add_scalar(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  add_all(moved, squared_overlap, lanes);
}

#ifdef GRIDLOCK_AVX512
GRIDLOCK_AVX512 void add_avx512(Displacements const& moved, double squared_overlap, Lanes& lanes) {
  add_all(moved, squared_overlap, lanes);
}

struct Coefficients {
  __m512d c0;
  __m512d c1;
  __m512d c2;
  __m512d c3;
};

/// Loads four coefficients of each of eight polynomials by loads and a transposition, which is faster than gathers.
GRIDLOCK_AVX512 inline Coefficients coefficients_of(double const* pieces, __m256i piece) {
  alignas(32) std::array<std::int32_t, lane_count> at;
  _mm256_store_si256(reinterpret_cast<__m256i*>(at.data()), _mm256_slli_epi32(piece, 2));
  __m512d rows[4];
  for (std::size_t l = 0; l < 4; ++l) {
    rows[l] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(pieces + at[l])),
                                 _mm256_loadu_pd(pieces + at[l + 4]), 1);
  }
  __m512d const even_low = _mm512_unpacklo_pd(rows[0], rows[1]);
  __m512d const odd_low = _mm512_unpackhi_pd(rows[0], rows[1]);
  __m512d const even_high = _mm512_unpacklo_pd(rows[2], rows[3]);
  __m512d const odd_high = _mm512_unpackhi_pd(rows[2], rows[3]);
  __m512i const first = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  __m512i const second = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  return {_mm512_permutex2var_pd(even_low, first, even_high), _mm512_permutex2var_pd(odd_low, first, odd_high),
          _mm512_permutex2var_pd(even_low, second, even_high), _mm512_permutex2var_pd(odd_low, second, odd_high)};
}

/// Adds J₀(q |Δr|) for eight agents at a time, and one by one for agents beyond the table.
GRIDLOCK_AVX512 void add_scattering_avx512(Displacements const& moved, double squared_q, BesselTable const& table,
                                           Eight& sums) {
  std::size_t k = 0;
  for (; k + lane_count <= moved.count; k += lane_count) {
    __m512d const dx = _mm512_sub_pd(_mm512_loadu_pd(moved.x1 + k), _mm512_loadu_pd(moved.x0 + k));
    __m512d const dy = _mm512_sub_pd(_mm512_loadu_pd(moved.y1 + k), _mm512_loadu_pd(moved.y0 + k));
    __m512d const square = _mm512_add_pd(_mm512_mul_pd(dx, dx), _mm512_mul_pd(dy, dy));
    __m512d const s = _mm512_mul_pd(_mm512_set1_pd(squared_q), square);
    __mmask8 const inside = _mm512_cmp_pd_mask(s, _mm512_set1_pd(BesselTable::end), _CMP_LT_OQ);
    __m512d const scaled = _mm512_mul_pd(s, _mm512_set1_pd(1.0 / BesselTable::width));
    __m256i const piece = _mm512_maskz_cvttpd_epi32(inside, scaled);
    __m512d const t = _mm512_sub_pd(scaled, _mm512_cvtepi32_pd(piece));
    auto const [c0, c1, c2, c3] = coefficients_of(table.pieces(), piece);
    Eight value = _mm512_add_pd(c2, _mm512_mul_pd(t, c3));
    value = _mm512_add_pd(c1, _mm512_mul_pd(t, value));
    value = _mm512_add_pd(c0, _mm512_mul_pd(t, value));
    for (std::size_t l = 0; inside != 0xFF && l < lane_count; ++l) {
      if ((inside >> l & 1U) == 0) value[l] = table(squared_q * moved.squared(k + l));
    }
    sums += value;
  }
  add_scattering_from(k, moved, squared_q, table, sums);
}
#endif

}  // namespace

DisplacementKernels fastest_displacement_kernels() {
#ifdef GRIDLOCK_AVX512
  if (uses_avx512()) return {.add = &add_avx512, .add_scattering = &add_scattering_avx512};
#endif
  return {.add = &add_scalar, .add_scattering = &add_scattering_scalar};
}

}  // namespace gridlock
