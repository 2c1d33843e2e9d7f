#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "engine/packed_turns.hpp"
#include "gridlock/grid/detail/waiting_in_block.hpp"

// This file is written once with Google Highway and compiled once for every target below, because it includes itself.
// It uses only headers of Highway; target() chooses the kernel that is called. SVE is left out: its registers have no
// fixed size, so no struct can hold them.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/batched_moves.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/highway-inl.hpp"
#include "engine/disks_in_registers-inl.hpp"
#include "engine/headings-inl.hpp"

// Without vector instructions the plain C++ in turn.hpp is faster than Highway with one lane.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

namespace {

using Block = PackedGrid::Block;

constexpr std::size_t most = PackedTurns::largest_batch;
/// A limit on the sub-steps, because they are counted in double precision.
constexpr std::uint64_t max_substeps = 1'000'000'000;

using Doubles = hn::CappedTag<double, 8>;
constexpr std::size_t lanes = hn::MaxLanes(Doubles());
static_assert(lanes <= PackedTurns::read_behind);
using Floats = hn::CappedTag<float, 16>;
constexpr std::size_t blocks_at_once = hn::MaxLanes(Floats()) / PackedGrid::slots;

/// A value of type T for each disk of a batch.
template <class T>
using Each = std::array<T, most>;

/// A vector that is not set to zero first; setting the arrays of a batch to zero would take as long as a whole turn.
struct Point {
  double x;
  double y;

  operator Vector() const { return {x, y}; }
};

/// The disks of a batch, as each phase of the computation leaves them for the next. A phase must not read as one
/// register what was just written number by number: the processor would wait until all the writes are done.
struct alignas(64) Turning {
  Each<double> x;
  Each<double> y;
  Each<double> displacement_x;  ///< displacement in a sub-step, in units of length
  Each<double> displacement_y;
  Each<double> end_x;  ///< x at the end of the turn if the disk meets no other
  Each<double> end_y;
  Each<double> radius;
  Each<double> column;  ///< column of the cell that holds the disk
  Each<double> row;
  Each<double> free_substeps;  ///< sub-steps before the one in which the disk meets its partner
  Each<Point> position;        ///< position at the end of the turn
  Each<float> sight_x;         ///< x at the end of a free turn, in cells, relative to the disk's own cell
  Each<float> sight_y;
  Each<float> limit;    ///< largest squared distance from the sight point at which another disk may be met
  Each<float> local_x;  ///< x at the end of the turn, in cells, relative to the disk's own cell
  Each<float> local_y;
  Each<std::uint64_t> near;  ///< bit slots · k + s is set where the disk in slot s of neighbouring block k may be met
  Each<DiskInTurn*> disk;
  Each<Block*> block;
  Each<std::uint32_t> partner;  ///< row of the disk that the moving disk meets, if it meets any
};

/// A set of turns of the batch: bit l stands for turn l.
using Turns = unsigned;

/// The vector type with as many lanes of single precision.
template <class D>
using Single = hn::Rebind<float, D>;

/// Coordinates in units of cells, relative to a cell given by its column or row.
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

/// Takes the turns of disks that have no common neighbour, as many at a time as a register has lanes.
///
/// turns         0 1 2 3 │ 4 5 6 7       end of the free turn, largest distance of disks to meet
///                   0, 1, 2 …               candidates: few, most turns have one or none
/// candidates    a – b c │ – d – e       sub-step in which a turn meets its first candidate, if it does;
///                   – – – f │               then the second …
/// turns         0, 1, 2 …               disks are moved, and those that meet a partner collide
///
/// Each turn does the same operations in the same order as take_turn(), so that its results are rounded alike.
class BatchedMoves {
  using Pair = hn::FixedTag<double, 2>;

 public:
  BatchedMoves(PackedTurns& turns, TurnsInOrder const& order, std::size_t first, std::size_t count)
      : turns_(turns),
        constants_(turns.constants()),
        view_(constants_.view),
        grid_(turns.grid()),
        rows_(order.rows + first),
        blocks_(order.blocks + first),
        slots_(order.slots + first),
        places_(order.places + first),
        results_(order.results),
        count_(count) {}

  void take() {
    Turns const all = (1U << count_) - 1U;
    by_registers(count_, [this](auto tag, std::size_t first) HWY_ATTR {
      find_disks(tag, first);
      aim(tag, first);
    });
    Turns const local = all & local_;
    // Between walls every cell has its neighbours at the same distances in memory, also at an edge.
    bool const has_images = view_.box.has_images();
    Turns together = look_around(local & (has_images ? far_from_edge_ : inside_));
    if (has_images) together |= without_candidates(local & ~far_from_edge_ & inside_);
    by_registers(count_, [this](auto tag, std::size_t first) HWY_ATTR { find_partners(tag, first); });
    // A self-propelled disk that is halted at once stays where it is.
    for (Turns left = together & ~stuck_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      hn::Store(hn::Load(Pair(), &t_.position[l].x), Pair(), &t_.disk[l]->position.x);
      // Chosen without a branch, because a processor cannot guess whether a disk stays in its cell.
      std::uint32_t const slot = slots_[l] | ((staying_ >> l & 1U) - 1U);
      place_within_cell(l, slot, t_.local_x[l], t_.local_y[l]);
    }
    for (Turns left = together & ~staying_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      grid_.move(rows_[l], t_.position[l]);
      note_order(*t_.block[l]);
      note_order(*grid_.place_of(rows_[l]).block);
    }
    // Sums of floating-point numbers depend on the order, so the remaining turns go one by one in their order.
    if (view_.is_propelled()) count_halted();
    Turns const colliding = view_.is_propelled() ? 0 : halted_;
    for (Turns left = colliding | (local & ~together); left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      if (colliding >> l & 1U) {
        collide(l, result_of(l).counters);
      } else {
        take_alone(l);
      }
    }
    for (Turns left = all & ~local; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      result_of(l).not_local.push_back(rows_[l]);
    }
    Counters& counters = result_of(0).counters;
    counters.moves += count_of(together);
    if (view_.is_propelled()) counters.add_swum(view_.substeps * count_of(together));
    counters.halted_moves += count_of(halted_);
    counters.distance_checks += checks_ * view_.substeps - checks_left_out_;
  }

 private:
  /// Calls visit(tag, first) for each register that holds some of `count` items, beginning with item `first`. The last
  /// register is half as wide where half is enough.
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

  /// Finds the disks of the turns in a register. Lanes beyond the last turn hold disks of no turn of this batch.
  template <class D>
  HWY_INLINE void find_disks(D tag, std::size_t first) {
    HWY_UNROLL(8)
    for (std::size_t l = first; l < first + hn::MaxLanes(tag); ++l) {
      t_.disk[l] = &view_.disks[rows_[l]];
      t_.block[l] = blocks_[l];
      t_.near[l] = 0;
    }
  }

  /// Computes where the disks in a register, from turn `first` on, end if they meet no other disk.
  template <class D>
  HWY_INLINE void aim(D tag, std::size_t first) {
    using Double = hn::Vec<D>;
    using IsTrue = hn::Mask<D>;
    Single<D> const single;
    TurnConstants const& c = constants_;
    Vectors<D> const position = positions_of(tag, &t_.disk[first]);
    Vectors<D> velocity = velocities_of(tag, &t_.disk[first]);
    if (view_.is_propelled()) velocity = turn_headings(tag, first, velocity);
    Double const radius = radii_of(tag, &t_.disk[first]);
    Vectors<D> const cells = cells_of(tag, &t_.block[first]);
    Double const duration = hn::Set(tag, c.duration);
    Double const squared_speed = squared_length(velocity.x, velocity.y);
    Double const contact = hn::Add(radius, hn::Set(tag, c.cutoff.contact(0.0)));

    // The condition of PackedTurns::is_local().
    Double const room = hn::Sub(hn::Sub(hn::Set(tag, c.room), contact), hn::Set(tag, c.cutoff.rounding()));
    Double const squared_displacement = hn::Mul(hn::Mul(squared_speed, duration), duration);
    IsTrue const local = hn::And(hn::Gt(room, hn::Zero(tag)), hn::Le(squared_displacement, hn::Mul(room, room)));

    // The limit of PackedTurns::find_near().
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

    // The end of take_turn() for a disk that meets no partner.
    hn::Store(position.x, tag, &t_.x[first]);
    hn::Store(position.y, tag, &t_.y[first]);
    hn::Store(radius, tag, &t_.radius[first]);
    hn::Store(cells.x, tag, &t_.column[first]);
    hn::Store(cells.y, tag, &t_.row[first]);
    Double const substep = hn::Set(tag, view_.substep);
    Double const displacement_x = hn::Mul(substep, velocity.x);
    Double const displacement_y = hn::Mul(substep, velocity.y);
    hn::Store(displacement_x, tag, &t_.displacement_x[first]);
    hn::Store(displacement_y, tag, &t_.displacement_y[first]);
    Double x = position.x;
    Double y = position.y;
    for (std::uint64_t m = 0; m < view_.substeps; ++m) {
      x = hn::Add(x, displacement_x);
      y = hn::Add(y, displacement_y);
    }
    local_ |= bits_of(tag, local) << first;
    if (view_.box.has_images()) {
      far_from_edge_ |=
          bits_of(tag, hn::And(is_inner(tag, cells.x, c.inner_columns), is_inner(tag, cells.y, c.inner_rows))) << first;
    }
    inside_ |= bits_of(tag, is_inside(tag, position, {x, y}, radius)) << first;
    hn::Store(x, tag, &t_.end_x[first]);
    hn::Store(y, tag, &t_.end_y[first]);
  }

  /// Turns the headings of the disks in a register, from turn `first` on. Returns their velocities.
  template <class D>
  HWY_INLINE Vectors<D> turn_headings(D tag, std::size_t first, Vectors<D> velocity) {
    velocity = HeadingTurns<D>::turned(*view_.heading, id_indices_of(tag, &t_.disk[first]), velocity);
    alignas(64) double turned[2 * hn::MaxLanes(D())];
    hn::StoreInterleaved2(velocity.x, velocity.y, tag, turned);
    std::size_t const end = std::min(count_ - first, hn::MaxLanes(tag));  // lanes behind belong to other turns
    for (std::size_t k = 0; k < end; ++k) {
      hn::Store(hn::Load(Pair(), turned + 2 * k), Pair(), &t_.disk[first + k]->velocity.x);
    }
    return velocity;
  }

  /// Returns whether disks stay between the walls, or inside the periodic edges, on the way from one point to another.
  /// Every sub-step adds the same displacement, so all positions lie between the two points, however they are rounded.
  template <class D>
  HWY_INLINE hn::Mask<D> is_inside(D tag, Vectors<D> from, Vectors<D> to, hn::Vec<D> radius) const {
    using Double = hn::Vec<D>;
    using IsTrue = hn::Mask<D>;
    TurnConstants const& c = constants_;
    Double const low_x = hn::Mul(radius, hn::Set(tag, c.radii_from_edge_x));
    Double const low_y = hn::Mul(radius, hn::Set(tag, c.radii_from_edge_y));
    Double const high_x = hn::Sub(hn::Set(tag, c.last_x), low_x);
    Double const high_y = hn::Sub(hn::Set(tag, c.last_y), low_y);
    IsTrue const in_x = hn::And(hn::Ge(hn::Min(from.x, to.x), low_x), hn::Le(hn::Max(from.x, to.x), high_x));
    IsTrue const in_y = hn::And(hn::Ge(hn::Min(from.y, to.y), low_y), hn::Le(hn::Max(from.y, to.y), high_y));
    return hn::And(in_x, in_y);
  }

  /// Finds the candidates of these turns. Returns the turns whose neighbouring cells have one block each.
  HWY_INLINE Turns look_around(Turns turns) {
    bool const may_have_further_blocks = grid_.has_further_blocks();
    std::ptrdiff_t const blocks_in_row = grid_.blocks_in_row();
    for (Turns left = turns; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      Block const* const here = t_.block[l];
      if (may_have_further_blocks && has_further_blocks(*here, constants_.block_offsets[0].data())) {
        turns &= ~(1U << l);
        continue;
      }
      std::uint64_t const near = near_of(l, here, blocks_in_row);
      t_.near[l] = near;
      checks_ += count_of(near);
      with_candidates_ |= static_cast<Turns>(near != 0) << l;
    }
    return turns;
  }

  /// Finds the candidates of turn l in a cell whose neighbours lie in memory as those of inner cells do, so that their
  /// addresses are computed and not loaded.
  HWY_INLINE std::uint64_t near_of(std::size_t l, Block const* here, std::ptrdiff_t blocks_in_row) const {
    Block const* const below = here - blocks_in_row;
    Block const* const above = here + blocks_in_row;
    return near_around({below - 1, below, below + 1, here - 1, here + 1, above - 1, above, above + 1}, l) |
           std::uint64_t{near_in(*here, l) & ~(1U << slots_[l])} << own_slots;
  }

  /// Returns those of these turns, at the edge of a periodic box, without candidates; distances are to the nearest
  /// images.
  Turns without_candidates(Turns turns) const {
    bool const may_have_further_blocks = grid_.has_further_blocks();
    for (Turns left = turns; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      Block const& here = *t_.block[l];
      std::ptrdiff_t const* const offset = constants_.block_offsets_at(here.column, here.row).data();
      Around around;
      for (std::size_t k = 0; k < around.size(); ++k) around[k] = &here + offset[k];
      bool const meets_nobody = !(may_have_further_blocks && has_further_blocks(here, offset)) &&
                                near_around(around, l) == 0 && (near_in(here, l) & ~(1U << slots_[l])) == 0;
      if (!meets_nobody) turns &= ~(1U << l);
    }
    return turns;
  }

  using Around = std::array<Block const*, TurnConstants::blocks_around>;

  /// Returns bits of the candidates of turn l in the neighbouring cells.
  template <std::size_t at_once = blocks_at_once>
  HWY_INLINE std::uint64_t near_around(Around const& around, std::size_t l) const {
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

  /// Returns bits of the candidates of turn l in its own cell, the disk itself among them.
  HWY_INLINE unsigned near_in(Block const& here, std::size_t l) const {
    hn::FixedTag<float, PackedGrid::slots> const tag;
    auto const dx = hn::Sub(hn::Load(tag, here.x.data()), hn::Set(tag, t_.sight_x[l]));
    auto const dy = hn::Sub(hn::Load(tag, here.y.data()), hn::Set(tag, t_.sight_y[l]));
    return bits_of(tag, hn::Le(squared_length(dx, dy), hn::Set(tag, t_.limit[l])));
  }

  static constexpr std::size_t own_slots = TurnConstants::blocks_around * PackedGrid::slots;

  /// Returns whether a cell next to the cell of this block has more disks than one block holds.
  [[nodiscard]] bool has_further_blocks(Block const& block, std::ptrdiff_t const* offset) const {
    Block const* const first = &std::as_const(grid_).block_at(block.column, block.row);
    std::uint32_t next = PackedGrid::none;
    for (std::size_t k = 0; k <= TurnConstants::blocks_around; ++k) next &= first[offset[k]].next;
    return next != PackedGrid::none;
  }

  /// The ends of turns that have a candidate.
  template <class D>
  struct Outcome {
    Vectors<D> at;
    hn::Vec<D> free_substeps;
    hn::Vec<D> squared;  ///< squared distance to the disk that is met
    hn::Mask<D> is_met;
  };

  /// Finds the partners of the turns in a register, and where the turns end.
  template <class D>
  HWY_INLINE void find_partners(D tag, std::size_t first) {
    constexpr std::size_t count = hn::MaxLanes(D());
    unsigned const with = with_candidates_ >> first & ((1U << count) - 1U);
    Vectors<D> const cells{hn::Load(tag, &t_.column[first]), hn::Load(tag, &t_.row[first])};
    if (with == 0) {
      end_at(tag, first, {hn::Load(tag, &t_.end_x[first]), hn::Load(tag, &t_.end_y[first])}, cells);
      return;
    }
    std::uint64_t near[count];
    std::uint32_t rows[count];
    DiskInTurn const* candidates[count];
    std::ptrdiff_t const* const offset = constants_.block_offsets[0].data();
    // Sets `rows` to the next candidate of each turn. Returns the turns that have further candidates.
    auto const next_candidates = [&]() HWY_ATTR {
      unsigned more = 0;
      for (std::size_t k = 0; k < count; ++k) {
        // A turn without a candidate looks at slot 0 of its own block, which always holds a disk. An empty slot would
        // not do: it keeps the row of a disk that has left, which another thread may be writing.
        std::size_t const bit = first_of(near[k] | std::uint64_t{1} << (own_slots + PackedGrid::slots));
        Block const& block = t_.block[first + k][offset[bit / PackedGrid::slots]];
        rows[k] = block.agent[bit % PackedGrid::slots];
        candidates[k] = &view_.disks[rows[k]];
        near[k] &= near[k] - 1;
        more |= (near[k] != 0 ? 1U : 0U) << k;
      }
      return more;
    };
    for (std::size_t k = 0; k < count; ++k) near[k] = t_.near[first + k];
    unsigned more = next_candidates();
    Outcome<D> outcome = meet(tag, first, candidates, with);
    for (std::size_t k = 0; k < count; ++k) t_.partner[first + k] = rows[k];
    if (view_.is_propelled()) more &= ~stuck_in(tag, outcome);
    while (more != 0) {
      unsigned const again = more;
      more = next_candidates();
      Outcome<D> const other = meet(tag, first, candidates, again);
      hn::Mask<D> const is_first = comes_first(tag, other, outcome, &t_.partner[first], rows);
      outcome = {
          {hn::IfThenElse(is_first, other.at.x, outcome.at.x), hn::IfThenElse(is_first, other.at.y, outcome.at.y)},
          hn::IfThenElse(is_first, other.free_substeps, outcome.free_substeps),
          hn::IfThenElse(is_first, other.squared, outcome.squared),
          hn::Or(other.is_met, outcome.is_met)};
      if (view_.is_propelled()) more &= ~stuck_in(tag, outcome);
      for (unsigned left = bits_of(tag, is_first); left != 0; left &= left - 1) {
        t_.partner[first + first_of(left)] = rows[first_of(left)];
      }
    }
    hn::Store(outcome.free_substeps, tag, &t_.free_substeps[first]);
    halted_ |= bits_of(tag, outcome.is_met) << first;
    if (view_.is_propelled()) stuck_ |= stuck_in(tag, outcome) << first;
    end_at(tag, first, outcome.at, cells);
  }

  /// Returns the turns that meet a disk in their first sub-step: no other candidate can halt them earlier.
  template <class D>
  static HWY_INLINE unsigned stuck_in(D tag, Outcome<D> const& outcome) {
    return bits_of(tag, hn::And(outcome.is_met, hn::Eq(outcome.free_substeps, hn::Zero(tag))));
  }

  /// Returns the turns that meet the disks in `rows` before their partners: the choice of Partner::consider(), for
  /// disks that are first met in different sub-steps.
  template <class D>
  HWY_INLINE hn::Mask<D> comes_first(D tag, Outcome<D> const& with_row, Outcome<D> const& with_partner,
                                     std::uint32_t const* partners, std::uint32_t const* rows) const {
    auto const is_same_substep = hn::Eq(with_row.free_substeps, with_partner.free_substeps);
    auto const is_nearer = hn::And(is_same_substep, hn::Lt(with_row.squared, with_partner.squared));
    auto const is_earlier = hn::Lt(with_row.free_substeps, with_partner.free_substeps);
    auto const is_as_near = hn::And(is_same_substep, hn::Eq(with_row.squared, with_partner.squared));
    unsigned has_lower_id = 0;
    for (unsigned left = bits_of(tag, hn::And(with_row.is_met, is_as_near)); left != 0; left &= left - 1) {
      std::size_t const k = first_of(left);
      bool const is_lower = view_.disks[rows[k]].id_index < view_.disks[partners[k]].id_index;
      has_lower_id |= (is_lower ? 1U : 0U) << k;
    }
    return hn::And(with_row.is_met, hn::Or(hn::Or(is_earlier, is_nearer), mask_of(tag, has_lower_id)));
  }

  /// Computes how the turns in a register that have a candidate end if they meet no other disk.
  template <class D>
  HWY_INLINE Outcome<D> meet(D tag, std::size_t first, DiskInTurn const* const* candidates,
                             unsigned with_candidate) const {
    using Double = hn::Vec<D>;
    Vectors<D> const other = positions_of(tag, candidates);
    Double const contact = hn::Add(hn::Load(tag, &t_.radius[first]), radii_of(tag, candidates));
    Double const squared_contact = hn::Mul(contact, contact);
    Double const displacement_x = hn::Load(tag, &t_.displacement_x[first]);
    Double const displacement_y = hn::Load(tag, &t_.displacement_y[first]);
    Double x = hn::Load(tag, &t_.x[first]);
    Double y = hn::Load(tag, &t_.y[first]);
    // Positions are advanced without a branch on whether the two disks are apart, so that no computation waits for it.
    Double last_x = x;
    Double last_y = y;
    Double squared = hn::Zero(tag);
    Double free_substeps = hn::Zero(tag);
    Double const one = hn::Set(tag, 1.0);
    hn::Mask<D> const is_asked = mask_of(tag, with_candidate);
    hn::Mask<D> apart = is_asked;
    for (std::uint64_t m = 0; m < view_.substeps; ++m) {
      last_x = hn::IfThenElse(apart, x, last_x);
      last_y = hn::IfThenElse(apart, y, last_y);
      x = hn::Add(x, displacement_x);
      y = hn::Add(y, displacement_y);
      Double const squared_now = squared_length(hn::Sub(other.x, x), hn::Sub(other.y, y));
      squared = hn::IfThenElse(apart, squared_now, squared);
      apart = hn::AndNot(hn::Lt(squared_now, squared_contact), apart);
      free_substeps = hn::IfThenElse(apart, hn::Add(free_substeps, one), free_substeps);
      if (view_.is_propelled() && hn::AllFalse(tag, apart)) {
        x = hn::Load(tag, &t_.end_x[first]);
        y = hn::Load(tag, &t_.end_y[first]);
        break;
      }
    }
    hn::Mask<D> const is_met = hn::AndNot(apart, is_asked);
    return {{hn::IfThenElse(is_met, last_x, x), hn::IfThenElse(is_met, last_y, y)}, free_substeps, squared, is_met};
  }

  /// True in the lanes whose bits are set.
  template <class D>
  static HWY_INLINE hn::Mask<D> mask_of(D tag, unsigned bits) {
    std::uint8_t const bytes[8] = {static_cast<std::uint8_t>(bits)};
    return hn::LoadMaskBits(tag, bytes);
  }

  template <class D>
  HWY_INLINE void end_at(D tag, std::size_t first, Vectors<D> to, Vectors<D> cells) {
    hn::StoreInterleaved2(to.x, to.y, tag, &t_.position[first].x);
    auto const columns = in_cells(tag, to.x, constants_.layout.columns_per_length(), cells.x);
    auto const rows = in_cells(tag, to.y, constants_.layout.rows_per_length(), cells.y);
    store_local(tag, &t_.local_x[first], columns, grid_.local_width());
    store_local(tag, &t_.local_y[first], rows, grid_.local_height());
    staying_ |= bits_of(tag, hn::And(is_from_0_to_1(tag, columns), is_from_0_to_1(tag, rows))) << first;
  }

  /// Writes the position of the disk of turn l into its slot; a slot that does not exist changes nothing. The two
  /// coordinates are written as one: the processor would wait if they were written singly and soon read as one.
  HWY_INLINE void place_within_cell(std::size_t l, std::uint32_t slot, float x, float y) {
    if constexpr (blocks_at_once == 1) {
      PackedGrid::place_within_cell(*t_.block[l], slot, {x, y});
    } else {
      hn::CappedTag<float, 2 * PackedGrid::slots> const tag;
      hn::Rebind<std::uint32_t, decltype(tag)> const numbers;
      float* const to = t_.block[l]->x.data();
      auto const slots = hn::And(hn::Iota(numbers, 0), hn::Set(numbers, PackedGrid::slots - 1));
      auto const is_slot = hn::RebindMask(tag, hn::Eq(slots, hn::Set(numbers, slot)));
      auto const place = hn::OddEvenBlocks(hn::Set(tag, y), hn::Set(tag, x));
      hn::Store(hn::IfThenElse(is_slot, place, hn::Load(tag, to)), tag, to);
    }
  }

  /// Takes the turn of a disk at an edge, or beside a cell with more disks than a block, by itself.
  void take_alone(std::size_t l) {
    Block const& here = *t_.block[l];
    if (view_.box.has_images() ||
        (grid_.has_further_blocks() && has_further_blocks(here, constants_.block_offsets[0].data()))) {
      turns_.take(turns_.prepare(rows_[l], here, slots_[l]), result_of(l).counters);
      return;
    }
    turns_.take({.near = near_of(l, &here, grid_.blocks_in_row()),
                 .disk = rows_[l],
                 .is_far_from_edge = false,
                 .needs_more_blocks = false},
                result_of(l).counters);
  }

  /// Brings the order of Ids in a block up to date after a disk has come or gone, for later readers.
  void note_order(Block& block) const {
    if (block.next != PackedGrid::none) return;
    note_order_of_ids(block, [this](std::uint32_t row) { return view_.disks[row].id_index; });
  }

  [[nodiscard]] TurnResult& result_of(std::size_t l) const { return *results_[places_[l]]; }

  /// Lets the disk of turn l collide with its partner.
  HWY_INLINE void collide(std::size_t l, Counters& counters) {
    auto const left_out = static_cast<std::uint64_t>(static_cast<double>(view_.substeps - 1) - t_.free_substeps[l]);
    checks_left_out_ += left_out * count_of(t_.near[l]);
    collide(*t_.disk[l], view_.disks[t_.partner[l]], counters);
  }

  /// Counts self-propelled disks that halt.
  void count_halted() {
    std::uint64_t lost = 0;
    for (Turns left = halted_; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      auto const left_out = static_cast<std::uint64_t>(static_cast<double>(view_.substeps - 1) - t_.free_substeps[l]);
      checks_left_out_ += left_out * count_of(t_.near[l]);
      lost += left_out + 1;
    }
    result_of(0).counters.pair_collisions += count_of(halted_);
    result_of(0).counters.swum -= static_cast<double>(lost);
  }

  /// Returns x + y in both lanes.
  static HWY_INLINE hn::Vec<Pair> sum(hn::Vec<Pair> v) { return hn::Add(v, hn::Shuffle01(v)); }

  /// The rule of collide() in turn.hpp, with x and y in one register.
  HWY_INLINE void collide(DiskInTurn& self, DiskInTurn& other, Counters& counters) const {
    Pair const tag;
    auto b = hn::Sub(hn::Load(tag, &other.position.x), hn::Load(tag, &self.position.x));
    if (view_.box.has_images()) {
      Vector const nearest = view_.box.displacement_inside(self.position, other.position);
      b = hn::OddEven(hn::Set(tag, nearest.y), hn::Set(tag, nearest.x));
    }
    auto const v_self = hn::Load(tag, &self.velocity.x);
    auto const v_other = hn::Load(tag, &other.velocity.x);
    double const approach = hn::GetLane(sum(hn::Mul(hn::Sub(v_self, v_other), b)));
    if (view_.contact == CollisionRule::approaching && !(approach > 0.0)) return;
    if (other.is_fixed()) return reflect_from_fixed(view_.box, self, other, counters);
    double const along = 2.0 * approach / ((self.mass + other.mass) * hn::GetLane(sum(hn::Mul(b, b))));
    auto const change_self = hn::Mul(hn::Set(tag, -other.mass * along), b);
    auto const change_other = hn::Mul(hn::Set(tag, self.mass * along), b);
    hn::Store(hn::Add(v_self, change_self), tag, &self.velocity.x);
    hn::Store(hn::Add(v_other, change_other), tag, &other.velocity.x);
    ++counters.pair_collisions;
    counters.pair_virial -= self.mass * hn::GetLane(sum(hn::Mul(b, change_self)));
  }

  PackedTurns& turns_;
  TurnConstants const& constants_;
  TurnView const& view_;
  PackedGrid& grid_;
  std::uint32_t const* rows_;
  Block* const* blocks_;
  std::uint8_t const* slots_;
  std::uint8_t const* places_;
  TurnResult* const* results_;
  std::size_t count_;
  Turns local_ = 0;
  Turns far_from_edge_ = 0;
  Turns inside_ = 0;   ///< turns whose disks neither reach a wall nor cross an edge if they meet no other
  Turns staying_ = 0;  ///< turns whose disks stay in their cells
  Turns halted_ = 0;
  Turns stuck_ = 0;  ///< turns of self-propelled disks that halt in their first sub-step
  Turns with_candidates_ = 0;
  std::uint64_t checks_ = 0;  ///< overlap checks in each sub-step
  std::uint64_t checks_left_out_ = 0;
  Turning t_;
};

}  // namespace

void take_batch(PackedTurns& turns, TurnsInOrder const& order, std::size_t first, std::size_t count) {
  if (turns.substeps() > max_substeps) {
    take_batch_scalar(turns, order, first, count);
  } else {
    BatchedMoves(turns, order, first, count).take();
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
