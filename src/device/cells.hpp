#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/on_device.hpp"
#include "device/backend.hpp"
#include "gridlock/grid/detail/packed_cells.hpp"

namespace gridlock::device {

/// The blocks that no cell uses, in a list that all threads of a launch take from and give to.
///
/// The head is the index of the first block and a number that each change raises, so that a thread that was overtaken
/// by others does not take an old head for the present one.
/// Source: R. K. Treiber, Systems programming: coping with parallelism (1986), IBM report RJ 5118.
struct FreeBlocks {
  std::uint64_t* head;

  GRIDLOCK_ON_DEVICE std::uint32_t take(PackedBlock* blocks) const {
    std::uint64_t first = load(*head);
    while (!replace(*head, first, next_head(first, load(blocks[index_of(first)].next)))) {
    }
    return index_of(first);
  }
  GRIDLOCK_ON_DEVICE void give(PackedBlock* blocks, std::uint32_t index) const {
    std::uint64_t first = load(*head);
    do {
      store(blocks[index].next, index_of(first));
    } while (!replace(*head, first, next_head(first, index)));
  }

 private:
  static constexpr unsigned bits_of_index = 32;
  static constexpr std::uint32_t index_of(std::uint64_t head) { return static_cast<std::uint32_t>(head); }
  static constexpr std::uint64_t next_head(std::uint64_t before, std::uint32_t index) {
    return ((before >> bits_of_index) + 1) << bits_of_index | index;
  }
};

/// A PackedGrid in the memory of the device, for ScalarTurns. Threads may move agents at the same time if their cells
/// are more than two cells apart.
class Cells : public PackedGeometry {
 public:
  /// `blocks` and `places` are those of a PackedGrid and begin a longer array, whose other blocks are free.
  Cells(PackedGeometry const& geometry, Block* blocks, std::uint32_t* places, FreeBlocks free_blocks)
      : PackedGeometry(geometry), blocks_(blocks), places_(places), free_blocks_(free_blocks) {}

  [[nodiscard]] constexpr Block& block_of(std::size_t agent) const { return blocks_[places_[agent] / slots]; }
  [[nodiscard]] constexpr std::uint32_t slot_of(std::size_t agent) const { return places_[agent] % slots; }
  [[nodiscard]] constexpr Block& block_at(int column, int row) const { return blocks_[index_at(column, row)]; }
  [[nodiscard]] constexpr int cell_of(std::size_t agent) const {
    Block const& block = block_of(agent);
    return block.row * layout().columns() + block.column;
  }
  /// Returns that a cell may have more than one block; nobody counts them.
  [[nodiscard]] static constexpr bool has_further_blocks() { return true; }

  [[nodiscard]] static constexpr unsigned near_bits(Block const& block, LocalPoint p, float limit) {
    unsigned bits = 0;
    for (unsigned s = 0; s < slots; ++s) {
      float const dx = block.x[s] - p.x;
      float const dy = block.y[s] - p.y;
      bits |= (dx * dx + dy * dy <= limit ? 1U : 0U) << s;
    }
    return bits;
  }
  [[nodiscard]] static constexpr unsigned near_bits(std::array<Block const*, 4> const& blocks,
                                                    std::array<LocalPoint, 4> const& points, float limit) {
    unsigned bits = 0;
    for (unsigned k = 0; k < 4; ++k) bits |= near_bits(*blocks[k], points[k], limit) << (slots * k);
    return bits;
  }

  template <class Visit>
  constexpr void for_each_in_cell(int cell, Visit visit) const {
    for (Block const* block = &blocks_[index_of(cell)];; block = &blocks_[block->next]) {
      for (unsigned s = 0; s < block->count; ++s) visit(static_cast<std::size_t>(block->agent[s]));
      if (block->next == none) return;
    }
  }
  template <class Visit>
  constexpr void for_each_in_block(int cell, int reach_columns, int reach_rows, Visit visit) const {
    layout().for_each_cell_in_block(cell, reach_columns, reach_rows, [&](int c) { for_each_in_cell(c, visit); });
  }

  GRIDLOCK_ON_DEVICE void move(std::size_t agent, Vector p) const {
    Block& block = block_of(agent);
    LocalPoint inside{};
    if (is_in(block.column, block.row, p, inside)) {
      write(block, slot_of(agent), inside);
    } else {
      take_out(agent);
      put(agent, cell_point_of(p));
    }
  }

 private:
  static constexpr void write(Block& block, std::size_t slot, LocalPoint p) {
    block.x[slot] = p.x;
    block.y[slot] = p.y;
  }

  // As in PackedGrid, only the first block of a cell or the second of several may have empty slots.

  GRIDLOCK_ON_DEVICE void take_out(std::size_t agent) const {
    Block& hole = block_of(agent);
    std::uint32_t const slot = slot_of(agent);
    Block& base = blocks_[index_of(hole.column, hole.row)];
    Block* const top = base.next == none ? &base : &blocks_[base.next];
    std::uint32_t const last = --top->count;
    std::uint32_t const filler = top->agent[last];
    write(hole, slot, {top->x[last], top->y[last]});
    hole.agent[slot] = filler;
    places_[filler] = places_[agent];
    write(*top, last, {nowhere, nowhere});
    if (last > 0 || base.next == none) return;
    std::uint32_t const dropped = base.next;
    base.next = top->next;
    free_blocks_.give(blocks_, dropped);
  }

  GRIDLOCK_ON_DEVICE void put(std::size_t agent, CellPoint const& at) const {
    std::size_t index = index_of(at.column, at.row);
    if (blocks_[index].count == slots) {
      Block& base = blocks_[index];
      index = base.next;
      if (index == none || blocks_[index].count == slots) index = add_block(base);
    }
    Block& block = blocks_[index];
    std::uint32_t const slot = block.count++;
    block.agent[slot] = static_cast<std::uint32_t>(agent);
    write(block, slot, near_cell(local(at.p, at.column, at.row)));
    places_[agent] = static_cast<std::uint32_t>(index * slots + slot);
  }

  GRIDLOCK_ON_DEVICE std::uint32_t add_block(Block& base) const {
    std::uint32_t const index = free_blocks_.take(blocks_);
    Block& block = blocks_[index];
    for (std::size_t s = 0; s < slots; ++s) write(block, s, {nowhere, nowhere});
    block.count = 0;
    block.column = base.column;
    block.row = base.row;
    store(block.next, base.next);
    base.next = index;
    return index;
  }

  Block* blocks_;
  std::uint32_t* places_;
  FreeBlocks free_blocks_;
};

}  // namespace gridlock::device
