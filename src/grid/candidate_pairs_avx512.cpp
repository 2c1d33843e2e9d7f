#include "core/avx512.hpp"
#include "grid/candidate_pairs.hpp"

// Written by hand, because one instruction moves the kept lanes together: Highway takes 1.1 times as long.

#if defined(__x86_64__) && defined(__GNUC__)

#include <array>
#include <bit>

namespace gridlock {

namespace {

using Block = PackedGrid::Block;

static_assert(PairBuffer::slack >= 16);

/// Four blocks in one register for each property, and the shift of a point that makes it relative to their cells.
struct FourBlocks {
  __m512 x;
  __m512 y;
  __m512i agent;
  __m512 shift_x;
  __m512 shift_y;
};

GRIDLOCK_AVX512 inline __m512i side_by_side(std::uint32_t const* a, std::uint32_t const* b, std::uint32_t const* c,
                                            std::uint32_t const* d) {
  auto const at = [](std::uint32_t const* first) { return reinterpret_cast<__m128i const*>(first); };
  __m256i const low = _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_load_si128(at(a))), _mm_load_si128(at(b)), 1);
  __m256i const high = _mm256_inserti128_si256(_mm256_castsi128_si256(_mm_load_si128(at(c))), _mm_load_si128(at(d)), 1);
  return _mm512_inserti64x4(_mm512_castsi256_si512(low), high, 1);
}

GRIDLOCK_AVX512 inline void load(FourBlocks& four, Block const& a, Block const& b, Block const& c, Block const& d) {
  four.x = fours_side_by_side(a.x.data(), b.x.data(), c.x.data(), d.x.data());
  four.y = fours_side_by_side(a.y.data(), b.y.data(), c.y.data(), d.y.data());
  four.agent = side_by_side(a.agent.data(), b.agent.data(), c.agent.data(), d.agent.data());
}

/// Returns pairs of an agent, in the lower half of each lane, with eight others.
GRIDLOCK_AVX512 inline __m512i pairs_of(__m512i agent, __m256i others) {
  return _mm512_or_si512(agent, _mm512_slli_epi64(_mm512_cvtepu32_epi64(others), 32));
}

// Operations and their order are those of add_pairs_of_row_scalar(), so that they round alike. Kept lanes are moved
// together and the register is written whole: writing single lanes takes ten times as long.

/// Writes the pairs of the agent in slot s with agents in later slots of its block. Returns the end of the pairs.
GRIDLOCK_AVX512 inline PairBuffer::Pair* write_pairs_at_home(Block const& home, std::uint32_t s, __m512 limit,
                                                             PairBuffer::Pair* pair) {
  __m128 const dx = _mm_sub_ps(_mm_load_ps(home.x.data()), _mm_set1_ps(home.x[s]));
  __m128 const dy = _mm_sub_ps(_mm_load_ps(home.y.data()), _mm_set1_ps(home.y[s]));
  __m128 const squared = _mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy));
  auto const later = static_cast<__mmask8>((14U << s) & 15U);
  __mmask8 const near = _mm_mask_cmp_ps_mask(later, squared, _mm512_castps512_ps128(limit), _CMP_LE_OQ);
  __m128i const agents = _mm_load_si128(reinterpret_cast<__m128i const*>(home.agent.data()));
  __m256i const others = _mm256_cvtepu32_epi64(_mm_maskz_compress_epi32(near, agents));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(pair),
                      _mm256_or_si256(_mm256_set1_epi64x(home.agent[s]), _mm256_slli_epi64(others, 32)));
  return pair + std::popcount(static_cast<unsigned>(near));
}

/// Writes the pairs of the agent in slot s with agents in four other blocks. Returns the end of the pairs.
GRIDLOCK_AVX512 inline PairBuffer::Pair* write_pairs(Block const& home, std::uint32_t s, FourBlocks const& four,
                                                     __m512 limit, PairBuffer::Pair* pair) {
  __m512 const dx = _mm512_sub_ps(four.x, _mm512_add_ps(_mm512_set1_ps(home.x[s]), four.shift_x));
  __m512 const dy = _mm512_sub_ps(four.y, _mm512_add_ps(_mm512_set1_ps(home.y[s]), four.shift_y));
  __m512 const squared = _mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy));
  __mmask16 const near = _mm512_cmp_ps_mask(squared, limit, _CMP_LE_OQ);
  __m512i const others = _mm512_maskz_compress_epi32(near, four.agent);
  __m512i const agent = _mm512_set1_epi64(home.agent[s]);
  auto const count = static_cast<std::size_t>(std::popcount(static_cast<unsigned>(near)));
  _mm512_storeu_si512(pair, pairs_of(agent, _mm512_castsi512_si256(others)));
  // Seldom more than eight of sixteen candidates are near.
  if (count > 8) _mm512_storeu_si512(pair + 8, pairs_of(agent, _mm512_extracti32x8_epi32(others, 1)));
  return pair + count;
}

/// Adds the pairs of a cell that looks at up to max_blocks_seen blocks.
GRIDLOCK_AVX512 void add_pairs_of_cell(PackedGrid const& grid, std::span<SeenBlock const> seen, __m512 limit,
                                       PairBuffer& buffer) {
  Block const* home = seen.front().block;
  // Empty blocks fill the last register where the number of blocks is no multiple of four.
  SeenBlock const nobody{&grid.empty_block(), 0.0F, 0.0F};
  std::array<FourBlocks, max_blocks_seen / 4> fours;
  for (std::size_t k = 1;; ++k) {
    std::size_t count = 0;
    for (std::size_t first = k; first < seen.size(); first += 4) {
      auto const at = [&](std::size_t n) { return first + n < seen.size() ? seen[first + n] : nobody; };
      SeenBlock const a = at(0), b = at(1), c = at(2), d = at(3);
      load(fours[count], *a.block, *b.block, *c.block, *d.block);
      fours[count].shift_x = each_four_times(a.shift_x, b.shift_x, c.shift_x, d.shift_x);
      fours[count].shift_y = each_four_times(a.shift_y, b.shift_y, c.shift_y, d.shift_y);
      ++count;
    }
    for (std::uint32_t s = 0; s < home->count; ++s) {
      PairBuffer::Pair* pair = buffer.room_for(PackedGrid::slots * (max_blocks_seen + 1));
      pair = write_pairs_at_home(*home, s, limit, pair);
      for (std::size_t n = 0; n < count; ++n) pair = write_pairs(*home, s, fours[n], limit, pair);
      buffer.keep_until(pair);
    }
    if (home->next == PackedGrid::none) return;
    home = &grid.next_of(*home);
  }
}

GRIDLOCK_AVX512 void add_pairs_of_row_avx512(HalfBlock& half, int row, PairBuffer& buffer) {
  PackedGrid const& grid = half.grid;
  float const w = grid.local_width();
  float const h = grid.local_height();
  __m512 const limit = _mm512_set1_ps(half.limit);
  FourBlocks around{};
  around.shift_x = each_four_times(-w, w, 0, -w);
  around.shift_y = each_four_times(0, -h, -h, -h);
  bool const is_3_by_3 = half.reach_columns <= 1 && half.reach_rows <= 1;
  RowOfCells const cells(grid, row);
  for (int column = 0; column < cells.columns(); ++column) {
    FiveBlocks const blocks = cells.at(column);
    if (!is_3_by_3 || !blocks.are_all()) {
      std::span<SeenBlock const> const seen = blocks_seen_from(half, column, row);
      if (seen.size() <= max_blocks_seen) {
        add_pairs_of_cell(grid, seen, limit, buffer);
      } else {
        add_pairs_of_cell_scalar(half, column, row, buffer);
      }
      continue;
    }
    load(around, blocks.east, blocks.north_west, blocks.north, blocks.north_east);
    PairBuffer::Pair* pair = buffer.room_for(5 * PackedGrid::slots * PackedGrid::slots);
    for (std::uint32_t s = 0; s < blocks.home.count; ++s) {
      pair = write_pairs(blocks.home, s, around, limit, write_pairs_at_home(blocks.home, s, limit, pair));
    }
    buffer.keep_until(pair);
  }
}

}  // namespace

AddPairsOfRow add_pairs_with_avx512(Target target) {
  return target == Target::avx512 ? add_pairs_of_row_avx512 : nullptr;
}

}  // namespace gridlock

#else

namespace gridlock {

AddPairsOfRow add_pairs_with_avx512(Target) { return nullptr; }

}  // namespace gridlock

#endif
