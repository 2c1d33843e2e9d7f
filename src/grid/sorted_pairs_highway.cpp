#include <algorithm>
#include <bit>

#include "grid/sorted_pairs.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel. Left out are targets that target() never returns, and
// SVE, whose registers have no fixed size.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "grid/sorted_pairs_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"
#include "grid/write_pairs-inl.hpp"

// Without vector instructions the plain C++ in sorted_pairs.cpp is faster than Highway with one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace {

#if HWY_TARGET == HWY_AVX3
constexpr std::size_t rows_per_step = 8;
#else
constexpr std::size_t rows_per_step = PairBytes::others;
#endif
using Numbers = hn::CappedTag<double, rows_per_step>;
constexpr std::size_t lanes = hn::MaxLanes(Numbers());
static_assert(rows_per_step % lanes == 0 && PairBuffer::slack >= rows_per_step);

/// Writes the pairs of an agent with those of rows_per_step others whose bits are set. Returns the end of the pairs.
HWY_INLINE PairBuffer::Pair* write_near(std::uint32_t agent, std::uint32_t const* others, unsigned bits,
                                        PairBuffer::Pair* pair) {
#if HWY_TARGET == HWY_AVX3
  // Written by hand, because Compress() of Highway 1.0 copies a table of two kilobytes for each register.
  __m512i const second =
      _mm512_slli_epi64(_mm512_cvtepu32_epi64(_mm256_loadu_si256(reinterpret_cast<__m256i const*>(others))), 32);
  __m512i const pairs = _mm512_or_si512(_mm512_set1_epi64(agent), second);
  _mm512_storeu_si512(pair, _mm512_maskz_compress_epi64(static_cast<__mmask8>(bits), pairs));
  return pair + std::popcount(bits);
#else
  return write_pairs(agent, others, bits, pair);
#endif
}

template <bool has_images>
HWY_INLINE void add_pairs(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, Box const* box,
                          PairBuffer& buffer) {
  // Copied, because a compiler cannot know that writing pairs does not change them.
  Numbers const tag;
  double const* const x = rows.x;
  double const* const y = rows.y;
  std::uint32_t const* const index = rows.index;
  std::size_t const size = rows.size;
  auto const squared_cutoff = hn::Set(tag, rows.squared_cutoff);
  double const width = has_images ? box->period_x() : 0.0;
  double const height = has_images ? box->period_y() : 0.0;
  for (std::size_t row = cell.first; row < cell.end; ++row) {
    auto const p_x = hn::Set(tag, x[row]);
    auto const p_y = hn::Set(tag, y[row]);
    auto const near_bits = [&](std::size_t other) HWY_ATTR {
      auto d_x = hn::Sub(hn::LoadU(tag, x + other), p_x);
      auto d_y = hn::Sub(hn::LoadU(tag, y + other), p_y);
      if constexpr (has_images) {
        d_x = nearest_image(d_x, width);
        d_y = nearest_image(d_y, height);
      }
      return bits_of(tag, hn::Lt(squared_length(d_x, d_y), squared_cutoff));
    };
    PairBuffer::Pair* pair = buffer.room_for(max_candidates);
    for (RowRange const& range : ranges) {
      std::size_t const end = range.end;
      for (std::size_t other = &range == ranges.data() ? row + 1 : range.first; other < end; other += rows_per_step) {
        if (other + rows_per_step > size) [[unlikely]] {
          RowRange const alone{row, row + 1};
          RowRange const rest[] = {alone, {other, end}};
          buffer.keep_until(pair);
          add_pairs_of_rows_scalar(rows, alone, rest, box, buffer);
          pair = buffer.room_for(max_candidates);
          continue;
        }
        // Rows behind the range are read, but not counted.
        unsigned near = 0;
        for (std::size_t k = 0; k < rows_per_step; k += lanes) near |= near_bits(other + k) << k;
        near &= (1U << std::min(end - other, rows_per_step)) - 1U;
        pair = write_near(index[row], index + other, near, pair);
      }
    }
    buffer.keep_until(pair);
  }
}

}  // namespace

void add_pairs_of_rows_highway(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, Box const* box,
                               PairBuffer& buffer) {
  if (box == nullptr || !box->has_images()) {
    add_pairs<false>(rows, cell, ranges, box, buffer);
  } else {
    add_pairs<true>(rows, cell, ranges, box, buffer);
  }
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

AddPairsOfRows add_pairs_of_rows_with_highway(Target target) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::add_pairs_of_rows_highway;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::add_pairs_of_rows_highway;
#endif
#if HWY_TARGETS & HWY_AVX3
  if (target == Target::avx512) return N_AVX3::add_pairs_of_rows_highway;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::add_pairs_of_rows_highway;
#endif
  return nullptr;
}

}  // namespace gridlock

#endif
