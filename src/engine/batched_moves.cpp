#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/packed_turns.hpp"

// Written once with Google Highway, and compiled once for every target below: this file includes itself. Only headers of Highway are
// used; target() chooses which of the kernels is called. Registers of SVE have no size and fit in no struct.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/batched_moves.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"

// The plain C++ beside is faster than Highway's one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace {

using Block = PackedGrid::Block;

constexpr std::size_t most = PackedTurns::largest_batch;
/// Turns that take less time together than one after the other.
constexpr std::size_t worth_it = 3;
/// Sub-steps are counted in double precision.
constexpr std::uint64_t most_substeps = 1'000'000'000;

using Doubles = hn::CappedTag<double, 8>;
constexpr std::size_t lanes = hn::MaxLanes(Doubles());
using Floats = hn::CappedTag<float, 16>;
constexpr std::size_t blocks_at_once = hn::MaxLanes(Floats()) / PackedGrid::slots;

/// A property of each disk that takes its turn.
template <class T>
using Each = std::array<T, most>;

/// A Vector that is not set to zero first, which would take as long as a whole turn.
struct Point {
  double x;
  double y;

  operator Vector() const { return {x, y}; }
};

/// The disks that take their turns, as the phases hand them on. What is written lane by lane is not read as a whole soon
/// after: that makes the processor wait until all before it is done.
struct alignas(64) Turning {
  Each<float> sight_x;  ///< seen from the cell of the disk: where it would come to
  Each<float> sight_y;
  Each<float> limit;    ///< of the squared distance from there to disks it may meet
  Each<float> local_x;  ///< seen from its cell: where it comes to if it meets nobody
  Each<float> local_y;
  Each<Point> position;  ///< the same point in the box
  Each<DiskInTurn*> disk;
  Each<Block*> block;
  Each<std::uint64_t> near;  ///< bit slots · k + s is set where the disk in slot s of block k around may be met
  Each<std::uint32_t> slot;  ///< in its block
  Each<std::uint32_t> free_substeps;  ///< before the one in which it meets its partner
  Each<std::uint32_t> partner;
  Each<double> nearest;   ///< squared distance of the partner where it is met
  Each<Point> halted_at;  ///< before that
};

/// Disks that may be met, those of one turn after those of another.
struct Candidates {
  std::array<std::uint32_t, most * 9 * PackedGrid::slots + lanes> row;
  std::array<std::uint8_t, most * 9 * PackedGrid::slots + lanes> turn;
  std::size_t count = 0;
};

/// Bit l is that of turn l.
using Turns = unsigned;

/// As many single-precision numbers.
template <class D>
using Single = hn::Rebind<float, D>;

template <class D>
struct Vectors {
  hn::Vec<D> x;
  hn::Vec<D> y;
};

/// Two numbers that are side by side in memory, of all disks.
template <class D>
HWY_INLINE Vectors<D> pairs_of(D tag, double const* const* from) {
  auto const even = side_by_side<2>(tag, from, 2);
  auto const odd = side_by_side<2>(tag, from + 1, 2);
  return {hn::InterleaveLower(tag, even, odd), hn::InterleaveUpper(tag, even, odd)};
}
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

/// Columns and rows of cells, as x and y.
template <class D>
HWY_INLINE Vectors<D> cells_of(D tag, Block const* const* blocks) {
  static_assert(offsetof(Block, row) == offsetof(Block, column) + sizeof(std::int32_t));
  hn::Repartition<std::int32_t, D> const numbers;
  hn::RebindToUnsigned<D> const words;
  std::int32_t const* from[hn::MaxLanes(D())];
  for (std::size_t k = 0; k < hn::MaxLanes(tag); ++k) from[k] = &blocks[k]->column;
  auto const both = hn::BitCast(words, side_by_side<2>(numbers, from));
  // Numbers below 2³² added to 2⁵² are the last bits of the sum.
  auto const two_to_52 = hn::Set(words, 0x4330'0000'0000'0000U);
  auto const to_double = [&](auto whole) HWY_ATTR {
    return hn::Sub(hn::BitCast(tag, hn::Or(whole, two_to_52)), hn::BitCast(tag, two_to_52));
  };
  return {to_double(hn::And(both, hn::Set(words, 0xffff'ffffU))), to_double(hn::ShiftRight<32>(both))};
}

/// Coordinates in cells, seen from one.
template <class D>
HWY_INLINE hn::Vec<D> in_cells(D tag, hn::Vec<D> p, double cells_per_length, hn::Vec<D> cells) {
  return hn::Sub(hn::Mul(p, hn::Set(tag, cells_per_length)), cells);
}

template <class D>
HWY_INLINE void store_local(D /*tag*/, float* to, hn::Vec<D> in_cells, float side) {
  Single<D> const single;
  hn::Store(hn::Mul(hn::DemoteTo(single, in_cells), hn::Set(single, side)), single, to);
}

template <class D>
HWY_INLINE hn::Mask<D> is_from_0_to_1(D tag, hn::Vec<D> v) {
  return hn::And(hn::Ge(v, hn::Zero(tag)), hn::Lt(v, hn::Set(tag, 1.0)));
}

template <class D>
HWY_INLINE hn::Mask<D> is_inner(D tag, hn::Vec<D> cells, unsigned inner) {
  return hn::And(hn::Ge(cells, hn::Set(tag, 1.0)), hn::Le(cells, hn::Set(tag, static_cast<double>(inner))));
}

std::size_t count_of(std::uint64_t bits) { return static_cast<std::size_t>(std::popcount(bits)); }
std::size_t first_of(std::uint64_t bits) { return static_cast<std::size_t>(std::countr_zero(bits)); }

/// Turns of disks without a common neighbour, as many at a time as a register holds.
///
///     turns         0 1 2 3 │ 4 5 6 7       where they would come to, how far they see
///     candidates    0 0 2 3 │ 3 3 6 7       whom they may meet: few, most turns one or none;
///                                           in which sub-step a turn meets a candidate, if at all
///     turns         0 1 2 3 4 5 6 7         moved, and those that meet somebody collide
///
/// The same operations in the same order as in one turn after the other, so that they round alike.
class BatchedMoves {
 public:
  BatchedMoves(PackedTurns& turns, std::span<std::uint32_t const> rows, ResultsOfTurns results)
      : turns_(turns),
        constants_(turns.constants()),
        view_(constants_.view),
        grid_(turns.grid()),
        rows_(rows),
        results_(results) {}

  void take() {
    Turns const all = (1U << rows_.size()) - 1U;
    by_registers(rows_.size(), [this](auto tag, std::size_t first) HWY_ATTR {
      find_disks(tag, first);
      aim(tag, first);
    });
    Turns const local = all & local_;
    Turns together = look_around<EdgeOfTurn::is_far>(local & far_from_edge_);
    if ((local & ~far_from_edge_ & inside_) != 0) {
      together |= look_around<EdgeOfTurn::may_be_met>(local & ~far_from_edge_ & inside_);
    }
    list_candidates();
    find_partners();
    for (Turns left = together & staying_ & ~halted_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      t_.disk[l]->position = t_.position[l];
      place_within_cell(l);
    }
    for (Turns left = together & ~staying_ & ~halted_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      t_.disk[l]->position = t_.position[l];
      grid_.move(rows_[l], t_.position[l]);
    }
    // In the order of the turns, on which sums of floating point numbers depend.
    for (Turns left = halted_ | (local & ~together); left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      if (halted_ >> l & 1U) {
        halt(l, results_.of(l).counters);
      } else {
        turns_.take(turns_.prepare(rows_[l]), results_.of(l).counters);
      }
    }
    for (Turns left = all & ~local; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      results_.of(l).not_local.push_back(rows_[l]);
    }
    Counters& counters = results_.any_counters();
    counters.moves += count_of(together);
    counters.halted_moves += count_of(halted_);
    counters.distance_checks += checks_ * view_.substeps - checks_left_out_;
  }

 private:
  /// Calls visit(tag, first) for every register of `count` items from `first` on, the last one half as wide where that will do.
  template <class Visit>
  HWY_INLINE static void by_registers(std::size_t count, Visit visit) {
    constexpr std::size_t half = std::max<std::size_t>(2, lanes / 2);
    for (std::size_t first = 0; first < count; first += lanes) {
      if (half < lanes && count - first <= half) {
        visit(hn::CappedTag<double, half>(), first);
      } else {
        visit(Doubles(), first);
      }
    }
  }

  /// Of the turns in a register; lanes beyond the last turn have its disk.
  template <class D>
  HWY_INLINE void find_disks(D tag, std::size_t first) {
    HWY_UNROLL(8)
    for (std::size_t l = first; l < first + hn::MaxLanes(tag); ++l) {
      std::uint32_t const row = rows_[std::min(l, rows_.size() - 1)];
      t_.disk[l] = &view_.disks[row];
      t_.block[l] = &grid_.block_of(row);
      t_.slot[l] = grid_.slot_of(row);
    }
  }

  /// Where the disks in a register are bound for, from turn `first` on, and where they come to if they meet nobody.
  template <class D>
  HWY_INLINE void aim(D tag, std::size_t first) {
    using Double = hn::Vec<D>;
    using IsTrue = hn::Mask<D>;
    Single<D> const single;
    TurnConstants const& c = constants_;
    Vectors<D> const position = positions_of(tag, &t_.disk[first]);
    Vectors<D> const velocity = velocities_of(tag, &t_.disk[first]);
    Double const radius = radii_of(tag, &t_.disk[first]);
    Vectors<D> const cells = cells_of(tag, &t_.block[first]);
    Double const duration = hn::Set(tag, c.duration);
    Double const squared_speed = squared_length(velocity.x, velocity.y);
    Double const contact = hn::Add(radius, hn::Set(tag, c.cutoff.contact(0.0)));

    // is_local()
    Double const room = hn::Sub(hn::Sub(hn::Set(tag, c.room), contact), hn::Set(tag, c.cutoff.rounding()));
    Double const squared_displacement = hn::Mul(hn::Mul(squared_speed, duration), duration);
    IsTrue const local = hn::And(hn::Gt(room, hn::Zero(tag)), hn::Le(squared_displacement, hn::Mul(room, room)));
    IsTrue const inner = hn::And(is_inner(tag, cells.x, c.inner_columns), is_inner(tag, cells.y, c.inner_rows));

    // find_near()
    Double const squared_cutoff =
        hn::Add(hn::Mul(contact, contact), hn::Mul(hn::Set(tag, c.duration * c.duration), squared_speed));
    auto const limit = hn::DemoteTo(single, hn::Mul(squared_cutoff, hn::Set(tag, c.limit_per_area)));
    hn::Store(hn::Add(limit, hn::Set(single, c.limit_error)), single, &t_.limit[first]);
    double const columns_per_length = c.layout.columns_per_length();
    double const rows_per_length = c.layout.rows_per_length();
    Double const end_x = hn::Add(position.x, hn::Mul(duration, velocity.x));
    Double const end_y = hn::Add(position.y, hn::Mul(duration, velocity.y));
    store_local(tag, &t_.sight_x[first], in_cells(tag, end_x, columns_per_length, cells.x), grid_.local_width());
    store_local(tag, &t_.sight_y[first], in_cells(tag, end_y, rows_per_length, cells.y), grid_.local_height());

    // take_turn() without partners
    Double const substep = hn::Set(tag, view_.substep);
    Double const displacement_x = hn::Mul(substep, velocity.x);
    Double const displacement_y = hn::Mul(substep, velocity.y);
    Double x = position.x;
    Double y = position.y;
    for (std::uint64_t m = 0; m < view_.substeps; ++m) {
      x = hn::Add(x, displacement_x);
      y = hn::Add(y, displacement_y);
    }
    hn::StoreInterleaved2(x, y, tag, &t_.position[first].x);
    Double const columns = in_cells(tag, x, columns_per_length, cells.x);
    Double const rows = in_cells(tag, y, rows_per_length, cells.y);
    store_local(tag, &t_.local_x[first], columns, grid_.local_width());
    store_local(tag, &t_.local_y[first], rows, grid_.local_height());
    local_ |= bits_of(tag, local) << first;
    far_from_edge_ |= bits_of(tag, inner) << first;
    inside_ |= bits_of(tag, is_inside(tag, position, {x, y}, radius)) << first;
    staying_ |= bits_of(tag, hn::And(is_from_0_to_1(tag, columns), is_from_0_to_1(tag, rows))) << first;
  }

  /// Whether disks stay within the walls, or in the box, from one point to the other. Every sub-step adds the same
  /// displacement, so all places are between these two, however they round.
  template <class D>
  HWY_INLINE hn::Mask<D> is_inside(D tag, Vectors<D> from, Vectors<D> to, hn::Vec<D> radius) const {
    using Double = hn::Vec<D>;
    using IsTrue = hn::Mask<D>;
    TurnConstants const& c = constants_;
    Double const low = hn::Mul(radius, hn::Set(tag, c.radii_from_edge));
    Double const high_x = hn::Sub(hn::Set(tag, c.last_x), low);
    Double const high_y = hn::Sub(hn::Set(tag, c.last_y), low);
    IsTrue const in_x = hn::And(hn::Ge(hn::Min(from.x, to.x), low), hn::Le(hn::Max(from.x, to.x), high_x));
    IsTrue const in_y = hn::And(hn::Ge(hn::Min(from.y, to.y), low), hn::Le(hn::Max(from.y, to.y), high_y));
    return hn::And(in_x, in_y);
  }

  /// Whom these turns, which come to no edge, may meet. Returns those whose cells around fit one block each and that meet
  /// nobody across an edge.
  template <EdgeOfTurn edge>
  HWY_INLINE Turns look_around(Turns turns) {
    std::ptrdiff_t const* offset = constants_.block_offsets[0].data();
    for (Turns left = turns; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      Block const* const here = t_.block[l];
      if constexpr (edge == EdgeOfTurn::may_be_met) offset = block_offsets_of(l);
      if (!constants_.fits_one_block && has_further_blocks(*here, offset)) {
        turns &= ~(1U << l);
        continue;
      }
      Block const* around[TurnConstants::blocks_around];
      for (std::size_t k = 0; k < TurnConstants::blocks_around; ++k) around[k] = &here[offset[k]];
      std::uint64_t const near = near_around(around, l) | std::uint64_t{near_in(*here, l) & ~(1U << t_.slot[l])} << 32;
      if constexpr (edge == EdgeOfTurn::may_be_met) {
        // Distances are those of the nearest images there.
        if (constants_.layout.is_periodic() && near != 0) {
          turns &= ~(1U << l);
          continue;
        }
      }
      t_.near[l] = near;
      checks_ += count_of(near);
      with_candidates_ |= static_cast<Turns>(near != 0) << l;
    }
    return turns;
  }

  /// Whom turn l may meet in the cells around.
  template <std::size_t at_once = blocks_at_once>
  HWY_INLINE std::uint64_t near_around(Block const* const* around, std::size_t l) const {
    static_assert(offsetof(Block, y) == offsetof(Block, x) + PackedGrid::slots * sizeof(float));
    Floats const tag;
    auto const sight_x = hn::Set(tag, t_.sight_x[l]);
    auto const sight_y = hn::Set(tag, t_.sight_y[l]);
    auto const limit = hn::Set(tag, t_.limit[l]);
    std::uint64_t near = 0;
    HWY_UNROLL(8)
    for (std::size_t k = 0; k < TurnConstants::blocks_around; k += at_once) {
      auto squared = hn::Zero(tag);
      if constexpr (at_once == 1) {
        float const* const shift = constants_.shift_of_block(k);
        auto const dx = hn::Sub(hn::Load(tag, around[k]->x.data()), hn::Add(sight_x, hn::Load(tag, shift)));
        auto const dy =
            hn::Sub(hn::Load(tag, around[k]->y.data()), hn::Add(sight_y, hn::Load(tag, shift + PackedGrid::slots)));
        squared = squared_length(dx, dy);
      } else {
        auto const sight = hn::OddEvenBlocks(sight_y, sight_x);
        auto const parts_of = [&](std::size_t first) HWY_ATTR {
          float const* from[at_once / 2];
          for (std::size_t n = 0; n < at_once / 2; ++n) from[n] = around[first + 2 * n]->x.data();
          auto const shift = hn::Load(tag, constants_.shift_of_block(first));
          auto const d = hn::Sub(side_by_side<2 * PackedGrid::slots>(tag, from), hn::Add(sight, shift));
          return hn::Mul(d, d);
        };
        // Blocks 0 x y 2 x y and 1 x y 3 x y become 0 x 1 y 2 x 3 y and 1 x 0 y 3 x 2 y.
        auto const even = parts_of(k);
        auto const odd = parts_of(k + 1);
        squared = hn::Add(hn::OddEvenBlocks(odd, even), hn::SwapAdjacentBlocks(hn::OddEvenBlocks(even, odd)));
      }
      near |= std::uint64_t{bits_of(tag, hn::Le(squared, limit))} << (k * PackedGrid::slots);
    }
    return near;
  }

  /// Whom turn l may meet in its cell, and itself.
  HWY_INLINE unsigned near_in(Block const& here, std::size_t l) const {
    hn::FixedTag<float, PackedGrid::slots> const tag;
    auto const dx = hn::Sub(hn::Load(tag, here.x.data()), hn::Set(tag, t_.sight_x[l]));
    auto const dy = hn::Sub(hn::Load(tag, here.y.data()), hn::Set(tag, t_.sight_y[l]));
    return bits_of(tag, hn::Le(squared_length(dx, dy), hn::Set(tag, t_.limit[l])));
  }

  /// Whether a cell around the one of this block has more disks than a block.
  [[nodiscard]] bool has_further_blocks(Block const& block, std::ptrdiff_t const* offset) const {
    Block const* const first = &std::as_const(grid_).block_at(block.column, block.row);
    std::uint32_t next = PackedGrid::none;
    for (std::size_t k = 0; k <= TurnConstants::blocks_around; ++k) next &= first[offset[k]].next;
    return next != PackedGrid::none;
  }

  [[nodiscard]] std::ptrdiff_t const* block_offsets_of(std::size_t l) const {
    return constants_.block_offsets_at(t_.block[l]->column, t_.block[l]->row).data();
  }

  HWY_INLINE void list_candidates() {
    std::size_t count = 0;
    for (Turns left = with_candidates_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      std::ptrdiff_t const* const offset =
          (far_from_edge_ >> l & 1U) != 0 ? constants_.block_offsets[0].data() : block_offsets_of(l);
      auto const add = [&](std::uint64_t near) HWY_ATTR {
        std::size_t const bit = first_of(near);
        candidates_.row[count] = t_.block[l][offset[bit / PackedGrid::slots]].agent[bit % PackedGrid::slots];
        candidates_.turn[count] = static_cast<std::uint8_t>(l);
      };
      std::uint64_t near = t_.near[l];
      add(near);
      ++count;
      near &= near - 1;
      // Whether there is a second is as good as random, a third is rare: the second is written in any case.
      add(near | std::uint64_t{1} << 35);
      count += near != 0 ? 1 : 0;
      near &= near - 1;
      for (; near != 0; near &= near - 1) {
        add(near);
        ++count;
      }
    }
    candidates_.count = count;
  }

  /// The disk of turn l is now in its cell where it comes to if it meets nobody. Written as a whole: what is written in halves and soon
  /// read as a whole makes the processor wait.
  HWY_INLINE void place_within_cell(std::size_t l) {
    if constexpr (blocks_at_once == 1) {
      PackedGrid::place_within_cell(*t_.block[l], t_.slot[l], {t_.local_x[l], t_.local_y[l]});
    } else {
      hn::CappedTag<float, 2 * PackedGrid::slots> const tag;
      hn::Rebind<std::uint32_t, decltype(tag)> const numbers;
      float* const to = t_.block[l]->x.data();
      auto const slots = hn::And(hn::Iota(numbers, 0), hn::Set(numbers, PackedGrid::slots - 1));
      auto const is_slot = hn::RebindMask(tag, hn::Eq(slots, hn::Set(numbers, t_.slot[l])));
      auto const place = hn::OddEvenBlocks(hn::Set(tag, t_.local_y[l]), hn::Set(tag, t_.local_x[l]));
      hn::Store(hn::IfThenElse(is_slot, place, hn::Load(tag, to)), tag, to);
    }
  }

  /// Whom the disks meet first.
  HWY_INLINE void find_partners() {
    if (candidates_.count == 0) return;
    // Lanes beyond the last candidate look at somebody too.
    for (std::size_t k = 0; k < lanes; ++k) {
      candidates_.row[candidates_.count + k] = candidates_.row[0];
      candidates_.turn[candidates_.count + k] = candidates_.turn[0];
    }
    by_registers(candidates_.count, [this](auto tag, std::size_t first) HWY_ATTR { find_partners(tag, first); });
  }

  /// Of the candidates in a register.
  template <class D>
  HWY_INLINE void find_partners(D tag, std::size_t first) {
    using Double = hn::Vec<D>;
    constexpr std::size_t count = hn::MaxLanes(D());
    auto const substeps = static_cast<std::uint32_t>(view_.substeps);
    DiskInTurn const* selves[count];
    DiskInTurn const* others[count];
    for (std::size_t k = 0; k < count; ++k) {
      selves[k] = t_.disk[candidates_.turn[first + k]];
      others[k] = &view_.disks[candidates_.row[first + k]];
    }
    Vectors<D> const from = positions_of(tag, selves);
    Vectors<D> const velocity = velocities_of(tag, selves);
    Vectors<D> const other = positions_of(tag, others);
    Double const contact = hn::Add(radii_of(tag, selves), radii_of(tag, others));
    Double const squared_contact = hn::Mul(contact, contact);
    Double const substep = hn::Set(tag, view_.substep);
    Double const displacement_x = hn::Mul(substep, velocity.x);
    Double const displacement_y = hn::Mul(substep, velocity.y);
    Double x = from.x;
    Double y = from.y;
    // Of the sub-step in which they meet, or the last one.
    Double before_x = x;
    Double before_y = y;
    Double nearest = hn::Zero(tag);
    Double met_in = hn::Zero(tag);
    hn::Mask<D> apart = hn::FirstN(tag, candidates_.count - first);
    for (std::uint32_t m = 0; m < substeps; ++m) {
      before_x = hn::IfThenElse(apart, x, before_x);
      before_y = hn::IfThenElse(apart, y, before_y);
      x = hn::Add(x, displacement_x);
      y = hn::Add(y, displacement_y);
      Double const squared = squared_length(hn::Sub(other.x, x), hn::Sub(other.y, y));
      nearest = hn::IfThenElse(apart, squared, nearest);
      met_in = hn::IfThenElse(apart, hn::Set(tag, static_cast<double>(m)), met_in);
      apart = hn::AndNot(hn::Lt(squared, squared_contact), apart);
    }
    std::size_t const valid = std::min(count, candidates_.count - first);
    unsigned const met = ((1U << valid) - 1U) & ~bits_of(tag, apart);
    if (met != 0) choose_partners(tag, met, first, {before_x, before_y}, met_in, nearest);
  }

  /// Of the candidates from `first` on that are met those that are met before others.
  template <class D>
  HWY_INLINE void choose_partners(D tag, unsigned met, std::size_t first, Vectors<D> before, hn::Vec<D> met_in,
                                  hn::Vec<D> nearest) {
    alignas(64) double substep[hn::MaxLanes(D())];
    alignas(64) double squared[hn::MaxLanes(D())];
    alignas(64) Point halted_at[hn::MaxLanes(D())];
    hn::Store(met_in, tag, substep);
    hn::Store(nearest, tag, squared);
    hn::StoreInterleaved2(before.x, before.y, tag, &halted_at[0].x);
    for (; met != 0; met &= met - 1) {
      std::size_t const k = first_of(met);
      std::size_t const l = candidates_.turn[first + k];
      std::uint32_t const row = candidates_.row[first + k];
      auto const free_substeps = static_cast<std::uint32_t>(substep[k]);
      if ((halted_ >> l & 1U) && !is_met_before(l, row, free_substeps, squared[k])) continue;
      halted_ |= 1U << l;
      t_.free_substeps[l] = free_substeps;
      t_.nearest[l] = squared[k];
      t_.partner[l] = row;
      t_.halted_at[l] = halted_at[k];
    }
  }

  /// The choice of Partner::consider(), of disks that are first met in different sub-steps.
  [[nodiscard]] bool is_met_before(std::size_t l, std::uint32_t row, std::uint32_t substep, double squared) const {
    if (substep != t_.free_substeps[l]) return substep < t_.free_substeps[l];
    if (squared != t_.nearest[l]) return squared < t_.nearest[l];
    return view_.disks[row].id_index < view_.disks[t_.partner[l]].id_index;
  }

  HWY_INLINE void halt(std::size_t l, Counters& counters) {
    std::uint64_t const left_out = view_.substeps - t_.free_substeps[l] - 1;
    checks_left_out_ += left_out * count_of(t_.near[l]);
    t_.disk[l]->position = t_.halted_at[l];
    collide(view_, rows_[l], t_.partner[l], counters);
    grid_.move(rows_[l], t_.halted_at[l]);
  }

  PackedTurns& turns_;
  TurnConstants const& constants_;
  TurnView const& view_;
  PackedGrid& grid_;
  std::span<std::uint32_t const> rows_;
  ResultsOfTurns results_;
  Turns local_ = 0;
  Turns far_from_edge_ = 0;
  Turns inside_ = 0;   ///< neither at a wall nor across an edge if they meet nobody
  Turns staying_ = 0;  ///< in their cells if they meet nobody
  Turns halted_ = 0;
  Turns with_candidates_ = 0;
  std::uint64_t checks_ = 0;  ///< in each sub-step
  std::uint64_t checks_left_out_ = 0;
  Turning t_;
  Candidates candidates_;
};

}  // namespace

void take_batch(PackedTurns& turns, std::span<std::uint32_t const> rows, ResultsOfTurns results) {
  if (rows.size() < worth_it || turns.substeps() > most_substeps) {
    take_batch_scalar(turns, rows, results);
  } else {
    BatchedMoves(turns, rows, results).take();
  }
}

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE

namespace gridlock {

TakeBatch batch_kernel(Target target) {
#if HWY_TARGETS & HWY_SSE4
  if (target == Target::sse4) return N_SSE4::take_batch;
#endif
#if HWY_TARGETS & HWY_AVX2
  if (target == Target::avx2) return N_AVX2::take_batch;
#endif
#if HWY_TARGETS & HWY_AVX3
  if (target == Target::avx512) return N_AVX3::take_batch;
#endif
#if HWY_TARGETS & HWY_NEON
  if (target == Target::neon) return N_NEON::take_batch;
#endif
  return take_batch_scalar;
}

}  // namespace gridlock

#endif
