// Values of the disks of a register, for kernels written with Google Highway; src/core/highway-inl.hpp says how it is
// included.

#if defined(GRIDLOCK_ENGINE_DISKS_IN_REGISTERS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_ENGINE_DISKS_IN_REGISTERS_INL_HPP
#undef GRIDLOCK_ENGINE_DISKS_IN_REGISTERS_INL_HPP
#else
#define GRIDLOCK_ENGINE_DISKS_IN_REGISTERS_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "core/highway-inl.hpp"
#include "engine/turn.hpp"
#include "gridlock/grid/detail/packed_grid.hpp"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

template <class D>
HWY_INLINE Vectors<D> positions_of(D tag, DiskInTurn const* const* disks) {
  double const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(tag); ++k) from[k] = &disks[k]->position.x;
  return pairs_of(tag, from);
}
template <class D>
HWY_INLINE Vectors<D> velocities_of(D tag, DiskInTurn const* const* disks) {
  double const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(tag); ++k) from[k] = &disks[k]->velocity.x;
  return pairs_of(tag, from);
}
template <class D>
HWY_INLINE hn::Vec<D> radii_of(D tag, DiskInTurn const* const* disks) {
  static_assert(offsetof(DiskInTurn, mass) == offsetof(DiskInTurn, radius) + sizeof(double));
  double const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(tag); ++k) from[k] = &disks[k]->radius;
  return pairs_of(tag, from).x;
}

/// The id index of each disk, with its row above it in a word of twice as many bits.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToUnsigned<D>> id_indices_of(D /*tag*/, DiskInTurn const* const* disks) {
  static_assert(offsetof(DiskInTurn, row_in_state) == offsetof(DiskInTurn, id_index) + sizeof(std::uint32_t));
  hn::Repartition<std::uint32_t, D> const numbers;
  std::uint32_t const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(D()); ++k) from[k] = &disks[k]->id_index;
  return hn::BitCast(hn::RebindToUnsigned<D>(), side_by_side<2>(numbers, from));
}

/// Columns and rows of the cells of these blocks, as numbers x and y in double precision.
template <class D>
HWY_INLINE Vectors<D> cells_of(D tag, PackedGrid::Block const* const* blocks) {
  static_assert(offsetof(PackedGrid::Block, row) == offsetof(PackedGrid::Block, column) + sizeof(std::int32_t));
  hn::Repartition<std::int32_t, D> const numbers;
  hn::RebindToUnsigned<D> const words;
  std::int32_t const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(tag); ++k) from[k] = &blocks[k]->column;
  auto const both = hn::BitCast(words, side_by_side<2>(numbers, from));
  // A whole number below 2³² becomes a double without a conversion: it is the last bits of 2⁵² plus the number.
  auto const two_to_52 = hn::Set(words, 0x4330'0000'0000'0000U);
  auto const to_double = [&](auto whole) HWY_ATTR {
    return hn::Sub(hn::BitCast(tag, hn::Or(whole, two_to_52)), hn::BitCast(tag, two_to_52));
  };
  return {to_double(hn::And(both, hn::Set(words, 0xffff'ffffU))), to_double(hn::ShiftRight<32>(both))};
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#endif
