#include "core/avx512.hpp"
#include "engine/packed_turns.hpp"

#if defined(__x86_64__) && defined(__GNUC__)

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace gridlock {

namespace {

using Block = PackedGrid::Block;

constexpr std::size_t lanes = 8;
constexpr std::size_t most = PackedTurns::largest_batch;
static_assert(most == 2 * lanes, "a turn is looked up in two registers");

/// Turns that take less time together than one after the other.
constexpr std::size_t worth_it = 3;
/// Sub-steps are counted in 32 bits.
constexpr std::uint64_t most_substeps = 1'000'000'000;

/// A property of each disk that takes its turn.
template <class T>
using Each = std::array<T, most>;

/// The disks that take their turns, as the phases hand them on. Nothing is written lane by lane and then read as a whole:
/// that makes the processor wait until all before it is done.
struct alignas(64) Turning {
  Each<Block*> block;
  Each<std::uint32_t> slot;  ///< in its block
  Each<float> local_x;       ///< seen from the cell of the disk: where it would come to, and then where it has come to
  Each<float> local_y;
  Each<float> limit;                  ///< of the squared distance from there to disks it may meet
  Each<std::uint32_t> candidates;     ///< how many it may meet
  Each<std::uint32_t> free_substeps;  ///< before the one in which it meets its partner
  Each<std::uint32_t> partner;
  Each<double> nearest;   ///< squared distance of the partner where it is met
  Each<Vector> position;  ///< at the end
};

/// Disks that may be met, those of one turn after those of another.
struct alignas(64) Candidates {
  /// Written at once, however few there are.
  static constexpr std::size_t slack = 16;
  /// Counted from the first agent of the disk's own block.
  std::array<std::int32_t, most * 9 * PackedGrid::slots + slack> where;
  std::array<std::uint8_t, most * 9 * PackedGrid::slots + slack> turn;
  std::size_t count = 0;
};

/// Bit l is that of turn l.
using Turns = unsigned;

GRIDLOCK_AVX512 inline __m512d side_by_side(__m256d low, __m256d high) {
  return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
}
GRIDLOCK_AVX512 inline __m256d side_by_side(__m128d low, __m128d high) {
  return _mm256_insertf128_pd(_mm256_castpd128_pd256(low), high, 1);
}
using Rows = std::array<std::uint32_t, lanes>;

struct Vectors {
  __m512d x;
  __m512d y;
};

GRIDLOCK_AVX512 inline Vectors positions_of(DiskInTurn const* disks, Rows const& rows) {
  auto const at = [&](std::size_t l) { return &disks[rows[l]].position.x; };
  __m512d const even = side_by_side(side_by_side(_mm_load_pd(at(0)), _mm_load_pd(at(2))),
                                    side_by_side(_mm_load_pd(at(4)), _mm_load_pd(at(6))));
  __m512d const odd = side_by_side(side_by_side(_mm_load_pd(at(1)), _mm_load_pd(at(3))),
                                   side_by_side(_mm_load_pd(at(5)), _mm_load_pd(at(7))));
  return {_mm512_unpacklo_pd(even, odd), _mm512_unpackhi_pd(even, odd)};
}

GRIDLOCK_AVX512 inline __m512d radii_of(DiskInTurn const* disks, Rows const& rows) {
  auto const at = [&](std::size_t l) { return &disks[rows[l]].radius; };
  return side_by_side(side_by_side(_mm_loadh_pd(_mm_load_sd(at(0)), at(1)), _mm_loadh_pd(_mm_load_sd(at(2)), at(3))),
                      side_by_side(_mm_loadh_pd(_mm_load_sd(at(4)), at(5)), _mm_loadh_pd(_mm_load_sd(at(6)), at(7))));
}

struct Motion {
  Vectors position;
  Vectors velocity;
};

GRIDLOCK_AVX512 inline Motion motion_of(DiskInTurn const* disks, Rows const& rows) {
  static_assert(offsetof(DiskInTurn, velocity) == offsetof(DiskInTurn, position) + sizeof(Vector));
  auto const at = [&](std::size_t l) { return &disks[rows[l]].position.x; };
  __m512d const d04 = side_by_side(_mm256_load_pd(at(0)), _mm256_load_pd(at(4)));
  __m512d const d15 = side_by_side(_mm256_load_pd(at(1)), _mm256_load_pd(at(5)));
  __m512d const d26 = side_by_side(_mm256_load_pd(at(2)), _mm256_load_pd(at(6)));
  __m512d const d37 = side_by_side(_mm256_load_pd(at(3)), _mm256_load_pd(at(7)));
  // x of disks 0 and 1, vx of both, the same of 4 and 5.
  __m512d const x_01 = _mm512_unpacklo_pd(d04, d15);
  __m512d const y_01 = _mm512_unpackhi_pd(d04, d15);
  __m512d const x_23 = _mm512_unpacklo_pd(d26, d37);
  __m512d const y_23 = _mm512_unpackhi_pd(d26, d37);
  __m512i const of_position = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
  __m512i const of_velocity = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  return {
      .position = {_mm512_permutex2var_pd(x_01, of_position, x_23), _mm512_permutex2var_pd(y_01, of_position, y_23)},
      .velocity = {_mm512_permutex2var_pd(x_01, of_velocity, x_23), _mm512_permutex2var_pd(y_01, of_velocity, y_23)}};
}

/// The columns and the rows of eight cells.
struct Cells {
  __m256i columns;
  __m256i rows;
};

/// Column and row of two cells.
GRIDLOCK_AVX512 inline __m128d cells_of(Block const& a, Block const& b) {
  static_assert(offsetof(Block, row) == offsetof(Block, column) + sizeof(std::int32_t));
  __m128i const of_a = _mm_loadl_epi64(reinterpret_cast<__m128i const*>(&a.column));
  __m128i const of_b = _mm_loadl_epi64(reinterpret_cast<__m128i const*>(&b.column));
  return _mm_castsi128_pd(_mm_unpacklo_epi64(of_a, of_b));
}

GRIDLOCK_AVX512 inline Cells cells_of(Block* const* blocks) {
  __m256d const low = side_by_side(cells_of(*blocks[0], *blocks[1]), cells_of(*blocks[2], *blocks[3]));
  __m256d const high = side_by_side(cells_of(*blocks[4], *blocks[5]), cells_of(*blocks[6], *blocks[7]));
  __m512i const both = _mm512_castpd_si512(side_by_side(low, high));
  return {_mm512_cvtepi64_epi32(both), _mm512_cvtepi64_epi32(_mm512_srli_epi64(both, 32))};
}

GRIDLOCK_AVX512 inline __m512d squared_length(__m512d x, __m512d y) {
  return _mm512_add_pd(_mm512_mul_pd(x, x), _mm512_mul_pd(y, y));
}

/// Coordinates in cells, seen from one.
GRIDLOCK_AVX512 inline __m512d in_cells(__m512d p, double cells_per_length, __m256i cells) {
  return _mm512_sub_pd(_mm512_mul_pd(p, _mm512_set1_pd(cells_per_length)), _mm512_cvtepi32_pd(cells));
}

GRIDLOCK_AVX512 inline void store_local(float* to, __m512d in_cells, float side) {
  _mm256_store_ps(to, _mm256_mul_ps(_mm512_cvtpd_ps(in_cells), _mm256_set1_ps(side)));
}

GRIDLOCK_AVX512 inline Turns is_from_0_to_1(__m512d v) {
  __mmask8 const from_0 = _mm512_cmp_pd_mask(v, _mm512_setzero_pd(), _CMP_GE_OQ);
  return _mm512_mask_cmp_pd_mask(from_0, v, _mm512_set1_pd(1.0), _CMP_LT_OQ);
}

GRIDLOCK_AVX512 inline Turns is_inner(__m256i cells, unsigned inner) {
  __m256i const from_first = _mm256_sub_epi32(cells, _mm256_set1_epi32(1));
  return _mm256_cmplt_epu32_mask(from_first, _mm256_set1_epi32(static_cast<int>(inner)));
}

/// Where eight disks are and how they move.
struct Course {
  Vectors from;
  Vectors displacement;  ///< of one sub-step
  __m512d radius;
  Cells cells;
  Turns local;
  Turns far_from_edge;
};

/// Of a property of all turns, that of the turn in each lane.
GRIDLOCK_AVX512 inline __m512d look_up(__m512d of_first, __m512i turn, __m512d of_last) {
  return _mm512_permutex2var_pd(of_first, turn, of_last);
}

/// Four blocks around a cell.
struct FourBlocks {
  __m512 shift_x;  ///< what is to be added to a point seen from the cell to see it from a block
  __m512 shift_y;
  __m512i where;  ///< of their agents, counted from the first agent of the cell's own block
};

GRIDLOCK_AVX512 inline __m512i where_blocks_are(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
  constexpr std::int32_t numbers_in_block = sizeof(Block) / sizeof(std::uint32_t);
  __m512i const blocks = _mm512_setr_epi32(a, a, a, a, b, b, b, b, c, c, c, c, d, d, d, d);
  __m512i const slots = _mm512_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
  return _mm512_add_epi32(_mm512_mullo_epi32(blocks, _mm512_set1_epi32(numbers_in_block)), slots);
}

/// A point seen from its cell, and the squared distance within which others are looked for.
struct Sight {
  __m512 x;
  __m512 y;
  __m512 limit;
};

GRIDLOCK_AVX512 inline __mmask16 near_slots(Sight const& sight, FourBlocks const& four, Block const& a, Block const& b,
                                            Block const& c, Block const& d) {
  __m512 const x = fours_side_by_side(a.x.data(), b.x.data(), c.x.data(), d.x.data());
  __m512 const y = fours_side_by_side(a.y.data(), b.y.data(), c.y.data(), d.y.data());
  __m512 const dx = _mm512_sub_ps(x, _mm512_add_ps(sight.x, four.shift_x));
  __m512 const dy = _mm512_sub_ps(y, _mm512_add_ps(sight.y, four.shift_y));
  return _mm512_cmp_ps_mask(_mm512_add_ps(_mm512_mul_ps(dx, dx), _mm512_mul_ps(dy, dy)), sight.limit, _CMP_LE_OQ);
}

GRIDLOCK_AVX512 inline __mmask8 near_slots(Sight const& sight, Block const& own, std::uint32_t slot) {
  __m128 const dx = _mm_sub_ps(_mm_load_ps(own.x.data()), _mm512_castps512_ps128(sight.x));
  __m128 const dy = _mm_sub_ps(_mm_load_ps(own.y.data()), _mm512_castps512_ps128(sight.y));
  __m128 const squared = _mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy));
  auto const others = static_cast<__mmask8>(~(1U << slot));
  return _mm_mask_cmp_ps_mask(others, squared, _mm512_castps512_ps128(sight.limit), _CMP_LE_OQ);
}

std::size_t count_of(unsigned bits) { return static_cast<std::size_t>(std::popcount(bits)); }
std::size_t first_of(unsigned bits) { return static_cast<std::size_t>(std::countr_zero(bits)); }

/// Whom the disks of a batch meet: the candidates of all turns one after the other, eight of them looked at at a time.
class Meetings {
 public:
  Meetings(TurnView const& view, PackedGrid const& grid, std::span<std::uint32_t const> rows, Turning& turning)
      : view_(view), grid_(grid), rows_(rows), turning_(turning) {}

  /// Whom these turns, which are far from the edge, may meet.
  GRIDLOCK_AVX512 void look_around(Turns turns) {
    auto const stride = static_cast<std::int32_t>(&grid_.block_at(0, 1) - &grid_.block_at(0, 0));
    float const w = grid_.local_width();
    float const h = grid_.local_height();
    FourBlocks const before{each_four_times(w, 0, -w, w), each_four_times(h, h, h, 0),
                            where_blocks_are(-stride - 1, -stride, -stride + 1, -1)};
    FourBlocks const behind{each_four_times(-w, w, 0, -w), each_four_times(0, -h, -h, -h),
                            where_blocks_are(1, stride - 1, stride, stride + 1)};
    __m128i const own_slots = _mm_setr_epi32(0, 1, 2, 3);
    std::int32_t* where = candidates_.where.data();
    std::size_t end = 0;
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      if (!(turns >> l & 1U)) continue;
      Block const* const here = turning_.block[l];
      Block const* const below = here - stride;
      Block const* const above = here + stride;
      Sight const sight{_mm512_set1_ps(turning_.local_x[l]), _mm512_set1_ps(turning_.local_y[l]),
                        _mm512_set1_ps(turning_.limit[l])};
      std::size_t const begin = end;
      __mmask16 const near_before = near_slots(sight, before, below[-1], below[0], below[1], here[-1]);
      _mm512_storeu_si512(where + end, _mm512_maskz_compress_epi32(near_before, before.where));
      end += count_of(near_before);
      __mmask16 const near_behind = near_slots(sight, behind, here[1], above[-1], above[0], above[1]);
      _mm512_storeu_si512(where + end, _mm512_maskz_compress_epi32(near_behind, behind.where));
      end += count_of(near_behind);
      __mmask8 const near_own = near_slots(sight, here[0], turning_.slot[l]);
      _mm_storeu_si128(reinterpret_cast<__m128i*>(where + end), _mm_maskz_compress_epi32(near_own, own_slots));
      end += count_of(near_own);
      __m128i const turn = _mm_set1_epi8(static_cast<char>(l));
      std::size_t k = begin;
      do {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(&candidates_.turn[k]), turn);
        k += sizeof turn;
      } while (k < end);
      turning_.candidates[l] = static_cast<std::uint32_t>(end - begin);
    }
    candidates_.count = end;
  }

  /// Whom the disks meet first; returns how many sub-steps each turn has before that.
  GRIDLOCK_AVX512 __m512i find_partners(Course const& first_eight, Course const& last_eight) {
    Turning& t = turning_;
    auto const substeps = static_cast<std::uint32_t>(view_.substeps);
    t.free_substeps.fill(substeps);
    __m512i free_substeps = _mm512_set1_epi32(static_cast<int>(substeps));
    // Lanes beyond the last candidate look at somebody too.
    _mm512_storeu_si512(&candidates_.where[candidates_.count], _mm512_setzero_si512());
    _mm_storeu_si128(reinterpret_cast<__m128i*>(&candidates_.turn[candidates_.count]), _mm_setzero_si128());
    for (std::size_t first = 0; first < candidates_.count; first += lanes) {
      std::uint8_t const* const turns = &candidates_.turn[first];
      Rows disks;
      for (std::size_t k = 0; k < lanes; ++k) {
        disks[k] = t.block[turns[k]]->agent.data()[candidates_.where[first + k]];
      }
      __m512i const turn = _mm512_cvtepu8_epi64(_mm_loadl_epi64(reinterpret_cast<__m128i const*>(turns)));
      __m512d x = look_up(first_eight.from.x, turn, last_eight.from.x);
      __m512d y = look_up(first_eight.from.y, turn, last_eight.from.y);
      __m512d const displacement_x = look_up(first_eight.displacement.x, turn, last_eight.displacement.x);
      __m512d const displacement_y = look_up(first_eight.displacement.y, turn, last_eight.displacement.y);
      __m512d const radius = look_up(first_eight.radius, turn, last_eight.radius);
      Vectors const other = positions_of(view_.disks.data(), disks);
      __m512d const contact = _mm512_add_pd(radius, radii_of(view_.disks.data(), disks));
      __m512d const squared_contact = _mm512_mul_pd(contact, contact);
      std::size_t const left = candidates_.count - first;
      auto const all = static_cast<__mmask8>(left >= lanes ? 0xff : (1U << left) - 1U);
      __mmask8 apart = all;
      __m512i met_in = _mm512_setzero_si512();
      __m512d nearest = _mm512_setzero_pd();
      for (std::uint32_t m = 0; m < substeps; ++m) {
        x = _mm512_add_pd(x, displacement_x);
        y = _mm512_add_pd(y, displacement_y);
        __m512d const squared = squared_length(_mm512_sub_pd(other.x, x), _mm512_sub_pd(other.y, y));
        // As long as they are apart, this may be the sub-step in which they meet.
        nearest = _mm512_mask_mov_pd(nearest, apart, squared);
        met_in = _mm512_mask_mov_epi64(met_in, apart, _mm512_set1_epi64(m));
        apart = _mm512_mask_cmp_pd_mask(apart, squared, squared_contact, _CMP_NLT_UQ);
      }
      alignas(64) std::array<std::uint64_t, lanes> substep;
      alignas(64) std::array<double, lanes> squared;
      _mm512_store_si512(substep.data(), met_in);
      _mm512_store_pd(squared.data(), nearest);
      for (unsigned met = all & ~static_cast<unsigned>(apart); met != 0; met &= met - 1) {
        std::size_t const k = first_of(met);
        std::size_t const l = turns[k];
        if (!is_met_before_others(l, disks[k], substep[k], squared[k])) continue;
        t.free_substeps[l] = static_cast<std::uint32_t>(substep[k]);
        t.nearest[l] = squared[k];
        t.partner[l] = disks[k];
        free_substeps =
            _mm512_mask_set1_epi32(free_substeps, static_cast<__mmask16>(1U << l), static_cast<int>(substep[k]));
      }
    }
    return free_substeps;
  }

 private:
  /// The choice of Partner::consider(), of disks that are first met in different sub-steps.
  [[nodiscard]] bool is_met_before_others(std::size_t l, std::uint32_t disk, std::uint64_t substep,
                                          double squared) const {
    Turning const& t = turning_;
    if (substep != t.free_substeps[l]) return substep < t.free_substeps[l];
    if (squared != t.nearest[l]) return squared < t.nearest[l];
    return view_.disks[disk].id_index < view_.disks[t.partner[l]].id_index;
  }

  TurnView const& view_;
  PackedGrid const& grid_;
  std::span<std::uint32_t const> rows_;
  Turning& turning_;
  Candidates candidates_;
};

}  // namespace

/// Turns of disks without a common neighbour, eight at a time.
///
///     turns         0 1 2 3 4 5 6 7         where they would come to, how far they see
///     candidates    0 0 2 3 3 3 6 7 │ 7     whom they may meet: few, most turns one or none
///                   8 at a time             in which sub-step a turn meets a candidate, if at all
///     turns         0 1 2 3 4 5 6 7         how far they come
///
/// The same operations in the same order as in one turn after the other, so that they round alike.
class BatchedMoves {
 public:
  BatchedMoves(PackedTurns& turns, std::span<std::uint32_t const> rows)
      : turns_(turns),
        view_(turns.view_),
        grid_(turns.grid_),
        rows_(rows),
        meetings_(turns.view_, turns.grid_, rows, turning_) {}

  GRIDLOCK_AVX512 void take(Counters& counters, std::vector<std::uint32_t>& not_local) {
    bool const are_many = rows_.size() > lanes;
    Course const first = aim(0);
    Course const last = are_many ? aim(lanes) : first;
    Turns const all = (1U << rows_.size()) - 1U;
    Turns const local = all & (first.local | last.local << lanes);
    Turns const far_from_edge = local & (first.far_from_edge | last.far_from_edge << lanes);
    Turns const together = turns_.fits_one_block_ ? far_from_edge : without_more_blocks(far_from_edge);
    Turns const alone = local & ~together;
    meetings_.look_around(together);
    __m512i const free_substeps = meetings_.find_partners(first, last);
    auto const substeps = static_cast<std::uint32_t>(view_.substeps);
    Turns const halted =
        together & _mm512_cmplt_epu32_mask(free_substeps, _mm512_set1_epi32(static_cast<int>(substeps)));
    Turns staying = go(0, first, _mm512_castsi512_si256(free_substeps));
    if (are_many) staying |= go(lanes, last, _mm512_extracti32x8_epi32(free_substeps, 1)) << lanes;
    for (std::size_t l = 0; l < rows_.size(); ++l) {
      if (!(together >> l & 1U)) continue;
      view_.disks[rows_[l]].position = turning_.position[l];
      PackedGrid::place_within_cell(*turning_.block[l], turning_.slot[l], {turning_.local_x[l], turning_.local_y[l]});
      std::uint32_t const trials = std::min(turning_.free_substeps[l] + 1, substeps);
      counters.distance_checks += std::uint64_t{turning_.candidates[l]} * trials;
    }
    // In the order of the turns, on which sums of floating point numbers depend.
    for (Turns left = halted | alone; left != 0; left &= left - 1) {
      std::size_t const l = first_of(left);
      if (halted >> l & 1U) {
        collide(view_, rows_[l], turning_.partner[l], counters);
      } else {
        turns_.take(turns_.prepare(rows_[l]), counters);
      }
    }
    for (Turns left = together & ~staying; left != 0; left &= left - 1) {
      std::uint32_t const i = rows_[first_of(left)];
      grid_.move(i, view_.disks[i].position);
    }
    for (Turns left = all & ~local; left != 0; left &= left - 1) not_local.push_back(rows_[first_of(left)]);
    counters.moves += count_of(together);
    counters.halted_moves += count_of(halted);
  }

 private:
  /// Where eight disks from turn `first` on are bound for.
  GRIDLOCK_AVX512 Course aim(std::size_t first) {
    Turning& t = turning_;
    Rows rows;
    for (std::size_t l = 0; l < lanes; ++l) {
      rows[l] = rows_[std::min(first + l, rows_.size() - 1)];
      t.block[first + l] = &grid_.block_of(rows[l]);
      t.slot[first + l] = grid_.slot_of(rows[l]);
    }
    Motion const disk = motion_of(view_.disks.data(), rows);
    __m512d const radius = radii_of(view_.disks.data(), rows);
    Cells const cells = cells_of(&t.block[first]);
    __m512d const duration = _mm512_set1_pd(turns_.duration_);
    __m512d const squared_speed = squared_length(disk.velocity.x, disk.velocity.y);
    __m512d const contact = _mm512_add_pd(radius, _mm512_set1_pd(turns_.cutoff_.contact(0.0)));

    // is_local()
    __m512d const room =
        _mm512_sub_pd(_mm512_sub_pd(_mm512_set1_pd(turns_.room_), contact), _mm512_set1_pd(turns_.cutoff_.rounding()));
    __m512d const squared_displacement = _mm512_mul_pd(_mm512_mul_pd(squared_speed, duration), duration);
    __mmask8 const has_room = _mm512_cmp_pd_mask(room, _mm512_setzero_pd(), _CMP_GT_OQ);
    Turns const local = _mm512_mask_cmp_pd_mask(has_room, squared_displacement, _mm512_mul_pd(room, room), _CMP_LE_OQ);

    // find_near()
    __m512d const squared_cutoff =
        _mm512_add_pd(_mm512_mul_pd(contact, contact),
                      _mm512_mul_pd(_mm512_set1_pd(turns_.duration_ * turns_.duration_), squared_speed));
    __m512d const limit = _mm512_mul_pd(squared_cutoff, _mm512_set1_pd(turns_.limit_per_area_));
    _mm256_store_ps(&t.limit[first], _mm256_add_ps(_mm512_cvtpd_ps(limit), _mm256_set1_ps(turns_.limit_error_)));
    __m512d const end_x = _mm512_add_pd(disk.position.x, _mm512_mul_pd(duration, disk.velocity.x));
    __m512d const end_y = _mm512_add_pd(disk.position.y, _mm512_mul_pd(duration, disk.velocity.y));
    store_local(&t.local_x[first], in_cells(end_x, turns_.layout_.columns_per_length(), cells.columns),
                grid_.local_width());
    store_local(&t.local_y[first], in_cells(end_y, turns_.layout_.rows_per_length(), cells.rows), grid_.local_height());

    __m512d const substep = _mm512_set1_pd(view_.substep);
    return {.from = disk.position,
            .displacement = {_mm512_mul_pd(substep, disk.velocity.x), _mm512_mul_pd(substep, disk.velocity.y)},
            .radius = radius,
            .cells = cells,
            .local = local,
            .far_from_edge = is_inner(cells.columns, turns_.inner_columns_) & is_inner(cells.rows, turns_.inner_rows_)};
  }

  [[nodiscard]] Turns without_more_blocks(Turns turns) const {
    for (Turns left = turns; left != 0; left &= left - 1) {
      Block const& home = *turning_.block[first_of(left)];
      if (PackedTurns::has_further_blocks(turns_.around_of(home))) turns &= ~(left & -left);
    }
    return turns;
  }

  /// Moves eight disks from turn `first` on as far as they come; returns which stay in their cells.
  GRIDLOCK_AVX512 Turns go(std::size_t first, Course const& course, __m256i free_substeps) {
    __m512d x = course.from.x;
    __m512d y = course.from.y;
    auto const substeps = static_cast<int>(view_.substeps);
    for (int m = 0; m < substeps; ++m) {
      __mmask8 const is_free = _mm256_cmpgt_epu32_mask(free_substeps, _mm256_set1_epi32(m));
      x = _mm512_mask_add_pd(x, is_free, x, course.displacement.x);
      y = _mm512_mask_add_pd(y, is_free, y, course.displacement.y);
    }
    __m512i const low = _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11);
    __m512i const high = _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
    _mm512_store_pd(&turning_.position[first].x, _mm512_permutex2var_pd(x, low, y));
    _mm512_store_pd(&turning_.position[first + lanes / 2].x, _mm512_permutex2var_pd(x, high, y));
    __m512d const columns = in_cells(x, turns_.layout_.columns_per_length(), course.cells.columns);
    __m512d const rows = in_cells(y, turns_.layout_.rows_per_length(), course.cells.rows);
    store_local(&turning_.local_x[first], columns, grid_.local_width());
    store_local(&turning_.local_y[first], rows, grid_.local_height());
    return is_from_0_to_1(columns) & is_from_0_to_1(rows);
  }

  PackedTurns& turns_;
  TurnView const& view_;
  PackedGrid& grid_;
  std::span<std::uint32_t const> rows_;
  Turning turning_;
  Meetings meetings_;
};

bool can_take_batch_with_avx512() { return uses_avx512(); }

GRIDLOCK_AVX512 void take_batch_avx512(PackedTurns& turns, std::span<std::uint32_t const> rows, Counters& counters,
                                       std::vector<std::uint32_t>& not_local) {
  if (rows.size() < worth_it || turns.substeps() > most_substeps) {
    take_batch_scalar(turns, rows, counters, not_local);
  } else {
    BatchedMoves(turns, rows).take(counters, not_local);
  }
}

}  // namespace gridlock

#else

namespace gridlock {

bool can_take_batch_with_avx512() { return false; }
void take_batch_avx512(PackedTurns& turns, std::span<std::uint32_t const> rows, Counters& counters,
                       std::vector<std::uint32_t>& not_local) {
  take_batch_scalar(turns, rows, counters, not_local);
}

}  // namespace gridlock

#endif
