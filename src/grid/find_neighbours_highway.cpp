#include <algorithm>
#include <bit>

#include "grid/find_neighbours_kernels.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel. AVX-512 has a kernel written by hand; SVE is left out,
// because its registers have no fixed size, so no struct can hold them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "grid/find_neighbours_highway.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

// Without vector instructions the plain C++ in find_neighbours.cpp is faster than Highway with one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace {

using Numbers = hn::CappedTag<double, 4>;
constexpr std::size_t lanes = hn::MaxLanes(Numbers());
static_assert(lanes == 2 || lanes == 4);
/// Number of rows that are searched without a branch: a wrong guess costs more than an unneeded register.
constexpr std::size_t rows_per_step = 2 * lanes;
constexpr std::size_t rows_per_group = 4;
static_assert(neighbour_slack >= rows_per_step && rows_per_step % rows_per_group == 0);

/// The rows of a group whose bits are set, for each set of bits: it replaces compress instructions.
struct SetRows {
  alignas(16) std::uint32_t of[1U << rows_per_group][rows_per_group] = {};
};
constexpr SetRows find_set_rows() {
  SetRows set;
  for (std::uint32_t bits = 0; bits < 1U << rows_per_group; ++bits) {
    std::size_t count = 0;
    for (std::uint32_t row = 0; row < rows_per_group; ++row) {
      if ((bits >> row & 1U) != 0) set.of[bits][count++] = row;
    }
  }
  return set;
}
constexpr SetRows set_rows = find_set_rows();

template <bool has_images>
HWY_INLINE std::size_t find(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found) {
  // Copied, because a compiler cannot know that writing to `found` does not change them.
  Numbers const tag;
  auto const p_x = hn::Set(tag, search.p.x);
  auto const p_y = hn::Set(tag, search.p.y);
  auto const squared_cutoff = hn::Set(tag, search.squared_cutoff);
  double const* const x = search.x;
  double const* const y = search.y;
  std::size_t const size = search.size;
  std::size_t const search_left_out = search.left_out;
  double const width = has_images ? search.box->period_x() : 0.0;
  double const height = has_images ? search.box->period_y() : 0.0;
  auto const near_bits = [&](std::size_t row) HWY_ATTR {
    auto d_x = hn::Sub(hn::LoadU(tag, x + row), p_x);
    auto d_y = hn::Sub(hn::LoadU(tag, y + row), p_y);
    if constexpr (has_images) {
      d_x = nearest_image(d_x, width);
      d_y = nearest_image(d_y, height);
    }
    return bits_of(tag, hn::Lt(squared_length(d_x, d_y), squared_cutoff));
  };
  std::uint32_t* top = found;
  auto const write_group = [&](std::size_t row, unsigned bits) HWY_ATTR {
    hn::FixedTag<std::uint32_t, rows_per_group> const rows_tag;
    auto const first = hn::Set(rows_tag, static_cast<std::uint32_t>(row));
    hn::StoreU(hn::Add(first, hn::Load(rows_tag, set_rows.of[bits])), rows_tag, top);
    top += std::popcount(bits);
  };
  for (RowRange const range : ranges) {
    for (std::size_t row = range.first; row < range.end; row += rows_per_step) {
      if (row + rows_per_step > size) [[unlikely]] {
        RowRange const rest{row, range.end};
        top += find_neighbours_scalar(search, {&rest, 1}, top);
        continue;
      }
      // Rows behind the range are read, but not counted.
      std::size_t const count = range.end - row;
      std::size_t const left_out = search_left_out - row;
      unsigned near = near_bits(row) | near_bits(row + lanes) << lanes;
      near &= (1U << std::min(count, rows_per_step)) - 1U;
      near &= ~(static_cast<unsigned>(left_out < rows_per_step) << left_out % rows_per_step);
      write_group(row, near % (1U << rows_per_group));
      if constexpr (rows_per_step > rows_per_group) write_group(row + rows_per_group, near >> rows_per_group);
    }
  }
  return static_cast<std::size_t>(top - found);
}

}  // namespace

std::size_t find_neighbours_highway(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found) {
  if (search.box == nullptr || !search.box->has_images()) return find<false>(search, ranges, found);
  return find<true>(search, ranges, found);
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

FindNeighbours find_neighbours_with_highway(Target target) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::find_neighbours_highway;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::find_neighbours_highway;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::find_neighbours_highway;
#endif
  return nullptr;
}

}  // namespace gridlock

#endif
