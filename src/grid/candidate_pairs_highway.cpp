#include <bit>

#include "grid/candidate_pairs.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel. AVX-512 has a kernel written by hand; SVE is left out,
// because its registers have no fixed size, so no struct can hold them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "grid/candidate_pairs_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"
#include "grid/write_pairs-inl.hpp"

// Without vector instructions the plain C++ in candidate_pairs.cpp is faster than Highway with one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace {

using Block = PackedGrid::Block;

constexpr std::size_t slots = PackedGrid::slots;
/// Two blocks in a register, or one where registers are narrow.
using Numbers = hn::CappedTag<float, 2 * slots>;
constexpr std::size_t blocks_per_register = hn::MaxLanes(Numbers()) / slots;
constexpr std::size_t max_registers = max_blocks_seen / blocks_per_register;
using Register = hn::Vec<Numbers>;
static_assert(PairBuffer::slack >= slots);

/// The agents of a register's blocks, and the shift of a point that makes it relative to their cells.
struct SeenRegister {
  HWY_INLINE SeenRegister() {}  // NOLINT: a default constructor would not be compiled for the target

  Register x;
  Register y;
  Register shift_x;
  Register shift_y;
  std::uint32_t const* agents[blocks_per_register];
};

// A template, so that code for two blocks is not compiled where a register holds one.

template <class Tag>
HWY_INLINE hn::Vec<Tag> each_four_times(Tag tag, float a, float b) {
  if constexpr (hn::MaxLanes(Tag()) == 2 * slots) {
    hn::Half<Tag> const block;
    return hn::Combine(tag, hn::Set(block, b), hn::Set(block, a));
  } else {
    return hn::Set(tag, a);
  }
}

/// Loads two blocks, or the first where a register holds one.
HWY_INLINE void load(SeenRegister& seen, Block const& a, Block const& b) {
  float const* const x[] = {a.x.data(), b.x.data()};
  float const* const y[] = {a.y.data(), b.y.data()};
  seen.x = side_by_side<slots>(Numbers(), x);
  seen.y = side_by_side<slots>(Numbers(), y);
  seen.agents[0] = a.agent.data();
  if constexpr (blocks_per_register == 2) seen.agents[blocks_per_register - 1] = b.agent.data();
}

// Operations and their order are those of add_pairs_of_row_scalar(), so that they round alike.

/// Writes the pairs of the agent in slot s with agents in later slots of its block. Returns the end of the pairs.
HWY_INLINE PairBuffer::Pair* write_pairs_at_home(Block const& home, std::uint32_t s, float limit,
                                                 PairBuffer::Pair* pair) {
  hn::FixedTag<float, slots> const tag;
  auto const d_x = hn::Sub(hn::Load(tag, home.x.data()), hn::Set(tag, home.x[s]));
  auto const d_y = hn::Sub(hn::Load(tag, home.y.data()), hn::Set(tag, home.y[s]));
  auto const squared = squared_length(d_x, d_y);
  unsigned const later = 14U << s & 15U;
  unsigned const near = bits_of(tag, hn::Le(squared, hn::Set(tag, limit))) & later;
  return write_pairs(home.agent[s], home.agent.data(), near, pair);
}

/// Writes the pairs of the agent in slot s with agents in other blocks. Returns the end of the pairs.
HWY_INLINE PairBuffer::Pair* write_pairs_with(Block const& home, std::uint32_t s, SeenRegister const& seen, float limit,
                                              PairBuffer::Pair* pair) {
  Numbers const tag;
  auto const d_x = hn::Sub(seen.x, hn::Add(hn::Set(tag, home.x[s]), seen.shift_x));
  auto const d_y = hn::Sub(seen.y, hn::Add(hn::Set(tag, home.y[s]), seen.shift_y));
  auto const squared = squared_length(d_x, d_y);
  unsigned near = bits_of(tag, hn::Le(squared, hn::Set(tag, limit)));
  for (std::uint32_t const* agents : seen.agents) {
    pair = write_pairs(home.agent[s], agents, near & 15U, pair);
    near >>= slots;
  }
  return pair;
}

/// Adds the pairs of a cell that looks at up to max_blocks_seen blocks.
HWY_NOINLINE void add_pairs_of_cell(PackedGrid const& grid, std::span<SeenBlock const> seen, float limit,
                                    PairBuffer& buffer) {
  Block const* home = seen.front().block;
  // Empty blocks fill the last register.
  SeenBlock const nobody{&grid.empty_block(), 0.0F, 0.0F};
  SeenRegister registers[max_registers];
  for (std::size_t k = 1;; ++k) {
    std::size_t count = 0;
    for (std::size_t first = k; first < seen.size(); first += blocks_per_register) {
      SeenBlock const a = seen[first];
      SeenBlock const b = first + 1 < seen.size() ? seen[first + 1] : nobody;
      load(registers[count], *a.block, *b.block);
      registers[count].shift_x = each_four_times(Numbers(), a.shift_x, b.shift_x);
      registers[count].shift_y = each_four_times(Numbers(), a.shift_y, b.shift_y);
      ++count;
    }
    for (std::uint32_t s = 0; s < home->count; ++s) {
      PairBuffer::Pair* pair = buffer.room_for(slots * (max_blocks_seen + 1));
      pair = write_pairs_at_home(*home, s, limit, pair);
      for (std::size_t n = 0; n < count; ++n) pair = write_pairs_with(*home, s, registers[n], limit, pair);
      buffer.keep_until(pair);
    }
    if (home->next == PackedGrid::none) return;
    home = &grid.next_of(*home);
  }
}

}  // namespace

void add_pairs_of_row_highway(HalfBlock& half, int row, PairBuffer& buffer) {
  PackedGrid const& grid = half.grid;
  float const w = grid.local_width();
  float const h = grid.local_height();
  float const limit = half.limit;
  float const shift_x[] = {-w, w, 0.0F, -w};
  float const shift_y[] = {0.0F, -h, -h, -h};
  SeenRegister around[4 / blocks_per_register];
  for (std::size_t n = 0; n < 4; n += blocks_per_register) {
    std::size_t const last = n + blocks_per_register - 1;
    around[n / blocks_per_register].shift_x = each_four_times(Numbers(), shift_x[n], shift_x[last]);
    around[n / blocks_per_register].shift_y = each_four_times(Numbers(), shift_y[n], shift_y[last]);
  }
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
    Block const* const others[] = {&blocks.east, &blocks.north_west, &blocks.north, &blocks.north_east};
    for (std::size_t n = 0; n < 4; n += blocks_per_register) {
      load(around[n / blocks_per_register], *others[n], *others[n + blocks_per_register - 1]);
    }
    PairBuffer::Pair* pair = buffer.room_for(5 * slots * slots);
    for (std::uint32_t s = 0; s < blocks.home.count; ++s) {
      pair = write_pairs_at_home(blocks.home, s, limit, pair);
      for (SeenRegister const& seen : around) pair = write_pairs_with(blocks.home, s, seen, limit, pair);
    }
    buffer.keep_until(pair);
  }
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

AddPairsOfRow add_pairs_with_highway(Target target) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::add_pairs_of_row_highway;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::add_pairs_of_row_highway;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::add_pairs_of_row_highway;
#endif
  return nullptr;
}

}  // namespace gridlock

#endif
