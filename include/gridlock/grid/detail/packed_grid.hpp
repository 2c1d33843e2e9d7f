#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/detail/look_ahead.hpp"
#include "gridlock/grid/cell_layout.hpp"
#include "gridlock/grid/detail/agent_pairs.hpp"
#include "gridlock/grid/detail/cell_window.hpp"
#include "gridlock/grid/detail/float4.hpp"
#include "gridlock/grid/detail/packed_cells.hpp"

namespace gridlock {

/// A grid laid out for vector instructions: the agents of a cell and their positions in it share a cache line, so that
/// one instruction tests four distances, and most agents are found to be too far without reading the population.
///
///     cell ─► ┌ x x x x │ y y y y │ agent ×4 │ next, count, column, row ┐   64 bytes
///             └──────────────────────────────────────────────│──────────┘
///                            next ─► another block, where a cell holds more than four agents
///
///     blocks are in the order of the cells; ∅ is an empty block, for a neighbour that a cell at a wall lacks:
///
///     rows    │ ∅ │ ∅ │ ∅ │ ∅ │
///          1  │   │   │   │ ∅ │
///          0  │ 0 │ 1 │ 2 │ ∅ │      the block before the first one of a row is the last one of the row below
///           ∅ │ ∅ │ ∅ │ ∅ │ ∅ │
///               0   1   2  columns
///
/// Positions inside a cell have single precision, 1e-7 of the longer side of a cell, which is their unit. They only
/// select candidates; the caller measures exact distances in double precision. Positions are relative to cells, so that
/// periodic edges need no extra work.
///
/// A grid may store only a window of the cells: all other cells count as empty. Cells keep their numbers in the whole
/// box.
///
/// Insert, erase and move cost O(1) whatever the size of the cell. Memory: 64 bytes for each block: one for each cell,
/// for each further four agents of a cell and for each empty cell at the edges; and 4 bytes for each agent.
/// Contract: an agent is inserted once before it is moved or erased (asserted), and moved whenever its position
/// changes.
class PackedGrid : public PackedGeometry {
 public:
  PackedGrid() = default;
  /// Makes a grid with room for agents 0 … agents − 1; reserve() later would take up to twice the memory.
  explicit PackedGrid(CellLayout const& layout, std::size_t agents = 0);
  /// Makes a grid that stores the cells of a window. Contract: the window lies inside walls.
  PackedGrid(CellLayout const& layout, CellWindow const& window, std::size_t agents);
  /// Makes a grid with agent i at (x[i], y[i]).
  /// Errors: Error for lists of different lengths, and for coordinates that are not finite.
  PackedGrid(CellLayout const& layout, std::span<double const> x, std::span<double const> y);

  [[nodiscard]] std::size_t size() const { return size_; }
  /// Returns a number of blocks that is enough for any positions of the agents.
  [[nodiscard]] std::size_t max_blocks_for(std::size_t agents) const;
  /// Returns the number of blocks besides one for each cell, also those no longer in use.
  [[nodiscard]] std::size_t further_blocks() const { return blocks_.size() - blocks_of_cells(); }
  /// Returns whether some cell has more than one block. If other threads move agents meanwhile, the answer is right for
  /// all cells that they do not change.
  [[nodiscard]] bool has_further_blocks() const {
    return std::atomic_ref(further_blocks_in_use_).load(std::memory_order_relaxed) != 0;
  }
  [[nodiscard]] bool contains(std::size_t agent) const { return agent < place_.size() && place_[agent] != none; }
  [[nodiscard]] int cell_of(std::size_t agent) const {
    Block const& block = block_of(agent);
    return block.row * layout().columns() + block.column;
  }

  void reserve(std::size_t agents) {
    if (agents > place_.size()) grow(agents);
  }

  void insert(std::size_t agent, Vector p) {
    if (agent >= place_.size()) grow(agent + 1);
    assert(place_[agent] == none);
    put(agent, cell_point_of(p));
    ++size_;
  }

  /// Inserts agents into one empty cell such that for_each_in_cell() visits them in this order. A cell copied from
  /// another grid in this way keeps the same order, also after later insertions and removals.
  template <class PlaceOf>
  void insert_in_order(std::span<std::uint32_t const> agents, PlaceOf place_of) {
    auto const insert_all = [&](std::span<std::uint32_t const> some) {
      for (std::uint32_t const agent : some) insert(agent, place_of(agent));
    };
    insert_all(agents.first(std::min(slots, agents.size())));
    if (agents.size() <= slots) return;
    // A new block is linked before earlier ones, and only the newest block may have empty slots.
    std::span<std::uint32_t const> const further = agents.subspan(slots);
    std::size_t const newest = (further.size() - 1) % slots + 1;
    for (std::size_t end = further.size(); end > newest; end -= slots) insert_all(further.subspan(end - slots, slots));
    insert_all(further.first(newest));
  }

  void erase(std::size_t agent) {
    assert(contains(agent));
    take_out(agent);
    place_[agent] = none;
    --size_;
  }

  /// Renumbers the agent `from` to `to`. Contract: no agent has the number `to`.
  void rename(std::size_t from, std::size_t to) {
    assert(contains(from) && to < place_.size() && place_[to] == none);
    Block& block = block_of(from);
    block.agent[slot_of(from)] = static_cast<std::uint32_t>(to);
    blocks_[index_of(block.column, block.row)].marks |= changed;
    place_[to] = std::exchange(place_[from], none);
  }

  // The functions below prefetch memory, so that births and deaths of many agents do not wait for it one by one.

  /// Before erase() and move(): prefetch the index of an agent, and some time later its block.
  void prefetch(std::size_t agent) const { gridlock::prefetch(place_.data() + agent); }
  void prefetch_block_of(std::size_t agent) const {
    if (place_[agent] != none) gridlock::prefetch(&block_of(agent));
  }
  /// Some time after prefetch_block_of(): prefetches the agent that erase() will move into the slot.
  void prefetch_successor_of(std::size_t agent) const {
    if (place_[agent] == none) return;
    Block const& block = block_of(agent);
    if (block.next != none) gridlock::prefetch(&blocks_[block.next]);
    if (block.count > 0) gridlock::prefetch(place_.data() + block.agent[block.count - 1]);
  }
  /// Before insert(): prefetch the cell of a point.
  void prefetch_cell_of(Vector p) const {
    gridlock::prefetch(&blocks_[index_of(layout().column_of(p.x), layout().row_of(p.y))]);
  }
  void prefetch_second_block_of(Vector p) const {
    Block const& block = blocks_[index_of(layout().column_of(p.x), layout().row_of(p.y))];
    if (block.next != none) gridlock::prefetch(&blocks_[block.next]);
  }

  /// Moves an agent. Threads may move agents at the same time if their cells are more than two cells apart.
  void move(std::size_t agent, Vector p) {
    assert(contains(agent));
    Block& block = block_of(agent);
    LocalPoint inside;
    if (is_in(block.column, block.row, p, inside)) {
      write_lanes(block, place_[agent] % slots, inside);
    } else {
      move_to_cell(agent, p);
    }
  }

  /// Moves the agent in a slot to `p` in the same cell, for a caller that has checked that its cell stays the same.
  static void place_within_cell(Block& block, std::uint32_t slot, LocalPoint p) { write_lanes(block, slot, p); }

  /// Moves every agent i of the grid to (x[i], y[i]).
  /// Errors: Error for lists of different lengths, or shorter than the number of agents.
  void move_all(std::span<double const> x, std::span<double const> y);

  template <class Visit>
  void for_each_in_cell(int cell, Visit visit) const {
    for_each_block(index_of(cell), [&](Block const& block) {
      for (std::uint32_t s = 0; s < block.count; ++s) visit(static_cast<std::size_t>(block.agent[s]));
    });
  }

  /// Calls visit(agent) for every agent of the block of cells around `cell`, the 3×3 block for reach 1, 1.
  template <class Visit>
  void for_each_in_block(int cell, int reach_columns, int reach_rows, Visit visit) const {
    layout().for_each_cell_in_block(cell, reach_columns, reach_rows, [&](int c) { for_each_in_cell(c, visit); });
  }

  /// Calls visit(j) once for every agent nearer to p than `cutoff`, and for a few farther ones, in the order of
  /// for_each_in_block(). Contract: the window contains the block of cells around p, without crossing a periodic edge
  /// outside it.
  template <class Visit>
  void for_each_candidate(Vector p, double cutoff, Visit visit) const;

  /// Calls visit(i, j) once for every pair nearer than `cutoff`, and for some farther pairs. May call expect(i, j)
  /// earlier, see visit_pairs().
  template <class Visit, class Expect = ExpectNothing>
  void for_each_candidate_pair(double cutoff, Visit visit, Expect expect = {}) const {
    find_candidate_pairs(cutoff, [&](std::span<AgentPair const> pairs) { visit_pairs(pairs, visit, expect); });
  }

  /// Calls on_pairs for portions of the pairs of for_each_candidate_pair(). Sixteen candidates are tested at a time
  /// with AVX-512, eight with AVX2, else four; pairs and order are the same.
  /// Errors: Error for a cutoff that is negative or NaN.
  void find_candidate_pairs(double cutoff, OnPairs const& on_pairs) const;

  /// Returns whether every agent is in exactly one block, of its cell, with its position.
  /// Cost: O(agents + cells); for tests and audits.
  [[nodiscard]] bool is_consistent() const;

  // The functions below are for searches with other conditions than a cutoff; see src/grid/candidate_pairs.cpp for an
  // example.

  [[nodiscard]] Block const& block_of(std::size_t agent) const { return blocks_[place_[agent] / slots]; }
  [[nodiscard]] Block& block_of(std::size_t agent) { return blocks_[place_[agent] / slots]; }
  [[nodiscard]] std::uint32_t slot_of(std::size_t agent) const { return place_[agent] % slots; }
  struct Place {
    Block* block;
    std::uint32_t slot;
  };
  [[nodiscard]] Place place_of(std::size_t agent) {
    std::uint32_t const place = place_[agent];
    return {.block = &blocks_[place / slots], .slot = static_cast<std::uint32_t>(place % slots)};
  }
  /// Returns the first block of a cell. Contract: the cell is in the window, or an empty cell beside it.
  [[nodiscard]] Block const& block_at(int column, int row) const { return blocks_[index_at(column, row)]; }
  [[nodiscard]] Block& block_at(int column, int row) {
    return const_cast<Block&>(std::as_const(*this).block_at(column, row));
  }
  [[nodiscard]] Block const& empty_block() const { return block_at(window().end_column, window().first_row); }
  /// Returns all blocks, first those of the cells; `next` is an index of this array.
  [[nodiscard]] std::span<Block const> blocks() const { return blocks_; }
  /// Returns for each agent the index of its block times `slots`, plus its slot.
  [[nodiscard]] std::span<std::uint32_t const> places() const { return place_; }
  [[nodiscard]] Block const& next_of(Block const& block) const { return blocks_[block.next]; }
  [[nodiscard]] Block& next_of(Block& block) { return blocks_[block.next]; }
  /// Returns true in the lanes of agents whose squared distance from `p` is at most `limit`; `p` is relative to the
  /// cell of the block.
  static Int4 is_near(Block const& block, LocalPoint p, float limit) {
    Float4 const dx = load(block.x) - p.x;
    Float4 const dy = load(block.y) - p.y;
    return dx * dx + dy * dy <= limit;
  }
  /// Returns the lanes of is_near() as bits, for one block or for four with a point each.
  static unsigned near_bits(Block const& block, LocalPoint p, float limit) { return bits_of(is_near(block, p, limit)); }
  static unsigned near_bits(std::array<Block const*, 4> const& blocks, std::array<LocalPoint, 4> const& points,
                            float limit) {
    auto const near = [&](std::size_t k) { return is_near(*blocks[k], points[k], limit); };
    return bits_of(near(0), near(1), near(2), near(3));
  }

 private:
  /// An array of blocks whose copies keep the capacity: threads that move agents must not make the array reallocate.
  class Blocks : public LargeArray<Block> {
   public:
    Blocks() = default;
    Blocks(Blocks const& other) : Blocks() {
      reserve(other.capacity());
      assign(other.begin(), other.end());
    }
    Blocks(Blocks&&) noexcept = default;
    Blocks& operator=(Blocks other) noexcept {
      swap(other);
      return *this;
    }
    ~Blocks() = default;
  };

  /// A spin lock; every copy of the grid has a lock of its own.
  class Lock {
   public:
    Lock() = default;
    Lock(Lock const&) noexcept {}
    Lock& operator=(Lock const&) noexcept { return *this; }
    void lock() {
      while (flag_.test_and_set(std::memory_order_acquire)) {
      }
    }
    void unlock() { flag_.clear(std::memory_order_release); }

   private:
    std::atomic_flag flag_;
  };

  template <class Visit>
  void for_each_block(std::size_t base, Visit visit) const {
    Block const* block = &blocks_[base];
    while (true) {
      visit(*block);
      if (block->next == none) return;
      block = &blocks_[block->next];
    }
  }

  static void write_place(Block& block, std::uint32_t slot, LocalPoint p) { write_lanes(block, slot, near_cell(p)); }
  static void write_lanes(Block& block, std::uint32_t slot, LocalPoint p) {
    store(block.x, with_lane(load(block.x), slot, p.x));
    store(block.y, with_lane(load(block.y), slot, p.y));
  }

  void grow(std::size_t agents);
  void put(std::size_t agent, CellPoint const& cell_point);
  void take_out(std::size_t agent);
  void move_to_cell(std::size_t agent, Vector p);
  /// Links a new block behind the first block of a cell.
  std::uint32_t add_block(Block& base);
  void drop_second_block(Block& base);

  Blocks blocks_;                    ///< first one block for each cell, then further blocks
  LargeArray<std::uint32_t> place_;  ///< for each agent: block · slots + slot
  std::uint32_t first_free_ = none;  ///< head of the list of unused further blocks, linked by `next`
  Lock further_blocks_;              ///< guards the growth of blocks_ and the list
  /// Atomic: threads read it while others write it.
  mutable std::size_t further_blocks_in_use_ = 0;
  std::size_t size_ = 0;
};

template <class Visit>
void PackedGrid::for_each_candidate(Vector p, double cutoff, Visit visit) const {
  int const reach_columns = layout().columns_within(cutoff);
  int const reach_rows = layout().rows_within(cutoff);
  p = layout().image_in_cell(p);
  int const column = layout().column_of(p.x);
  int const row = layout().row_of(p.y);
  if (layout().goes_around(reach_columns, reach_rows)) {
    for_each_in_block(row * layout().columns() + column, reach_columns, reach_rows, visit);
    return;
  }
  float const limit = local_limit(cutoff * cutoff, std::max(reach_columns, reach_rows));
  LocalPoint const inside = local(p, column, row);
  LocalPoint const here = near_cell(inside);
  bool const has_all_columns = window().end_column - window().first_column >= layout().columns();
  bool const has_all_rows = window().end_row - window().first_row >= layout().rows();
  // All agents of a block are written, and only the count depends on distances: no branch to mispredict, see
  // PairBuffer.
  std::array<std::uint32_t, 64> found;
  std::size_t count = 0;
  auto const hand_out = [&] {
    for (std::size_t k = 0; k < count; ++k) visit(static_cast<std::size_t>(found[k]));
    count = 0;
  };
  layout().for_each_cell_seen_from(column, row, reach_columns, reach_rows, [&](CellLayout::CellSeen cell) {
    LocalPoint const seen{here.x - static_cast<float>(cell.to_the_right) * local_width(),
                          here.y - static_cast<float>(cell.up) * local_height()};
    int const seen_column = has_all_columns ? cell.column : column + cell.to_the_right;
    int const seen_row = has_all_rows ? cell.row : row + cell.up;
    for (Block const* block = &block_at(seen_column, seen_row);; block = &blocks_[block->next]) {
      unsigned const near = bits_of(is_near(*block, seen, limit));
      if (count + slots > found.size()) hand_out();
      for (std::size_t s = 0; s < slots; ++s) {
        found[count] = block->agent[s];
        count += (near >> s) & 1U;
      }
      if (block->next == none) break;
    }
  });
  hand_out();
}

}  // namespace gridlock
