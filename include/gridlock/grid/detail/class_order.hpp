#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/grid/detail/packed_grid.hpp"
#include "gridlock/grid/detail/tiling.hpp"
#include "gridlock/grid/detail/waiting_in_block.hpp"

namespace gridlock {

/// The order of turns in tiles of one colour, which touch no common cell. The cells of a tile form nine classes of
/// cells three apart in both directions, whose turns come class by class. A class has levels: first the agent with the
/// lowest Id of every cell, then the agent with the second lowest Id, and so on. In a level the turns come tile after
/// tile.
///
///     classes    6 7 8 6 7 8     The agents of one class and one level have no neighbour in common, so their turns
///     of cells:  3 4 5 3 4 5     can be prepared together before any of them is taken.
///                0 1 2 0 1 2
///
/// An order found at the beginning of a class stays right: no agent of the class moves before its turn, and agents that
/// move into its cells have already had their turns.
class ClassOrder {
 public:
  using Block = PackedGrid::Block;
  static constexpr std::size_t classes = 9;
  /// The number of entries behind the last turn that may be read; they repeat the last turn.
  static constexpr std::size_t beyond = 8;

  /// Finds the turns of a class. id_of(row) returns the Id of a row, or a number in the same order, and any number for
  /// an unused row. take_waiting(block), called once for each block, returns its marks with bit s of the slots set if
  /// and only if the agent in slot s waits for its turn.
  template <class IdOf, class TakeWaiting>
  void find(PackedGrid& grid, Tiling const& tiling, std::span<std::uint32_t const> tiles, std::size_t of_class,
            IdOf id_of, TakeWaiting take_waiting) {
    size_ = 0;
    several_size_ = 0;
    chains_.clear();
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      add_tile(grid, tiling.tiles()[tiles[k]], static_cast<std::uint8_t>(k), of_class, id_of, take_waiting);
    }
    end_of_first_ = size_;
    if (several_size_ > 0) add_levels();
    if (size_ > 0) {
      std::fill_n(rows_.begin() + static_cast<std::ptrdiff_t>(size_), beyond, rows_[size_ - 1]);
      std::fill_n(blocks_.begin() + static_cast<std::ptrdiff_t>(size_), beyond, blocks_[size_ - 1]);
    }
  }

  [[nodiscard]] std::size_t size() const { return size_; }

  // These arrays have one entry for each agent, in the order of the turns.
  [[nodiscard]] std::uint32_t const* rows() const { return rows_.data(); }
  /// Returns for each agent the index of its tile in `tiles` of find().
  [[nodiscard]] std::uint8_t const* tiles() const { return tiles_.data(); }
  /// Return the block and slot of each agent, valid only for the last batch.
  [[nodiscard]] Block* const* blocks() const { return blocks_.data(); }
  [[nodiscard]] std::uint8_t const* slots() const { return slots_.data(); }

  /// Returns the end of a batch of up to `most` agents of different cells that begins with `first`. Contract: all
  /// agents before `first` have had their turns.
  [[nodiscard]] std::size_t next_batch(PackedGrid& grid, std::size_t first, std::size_t most) {
    std::size_t const limit = std::min(first + most, size_);
    std::size_t end = std::min(limit, std::max(first, end_of_first_));
    std::uint32_t const* const after = after_.data();
    std::uint32_t const* const rows = rows_.data();
    Block** const blocks = blocks_.data();
    std::uint8_t* const slots = slots_.data();
    // A batch has at most one agent of a cell, since the turn of the one before may move it to another slot.
    for (; end < limit && after[end] < first; ++end) {
      PackedGrid::Place const place = grid.place_of(rows[end]);
      blocks[end] = place.block;
      slots[end] = static_cast<std::uint8_t>(place.slot);
    }
    return end;
  }

 private:
  /// A cell in which several agents wait for their turns.
  struct Several {
    std::uint32_t last;     ///< index of the last turn added for the cell
    std::uint32_t waiting;  ///< entry of WaitingInBlock::waiting, or is_chain and an index in chains_
  };
  static constexpr std::uint32_t is_chain = 1U << 31;

  void make_room(std::size_t size) {
    if (rows_.size() >= size + beyond) return;
    std::size_t const room = 2 * (size + beyond);
    rows_.resize(room);
    blocks_.resize(room);
    slots_.resize(room);
    tiles_.resize(room);
    after_.resize(room);
    several_.resize(room);
  }

  /// Adds the first waiting agent of each cell of a tile. No branch depends on which agents wait, since the processor
  /// cannot predict it.
  template <class IdOf, class TakeWaiting>
  void add_tile(PackedGrid& grid, Tiling::Tile const& tile, std::uint8_t number, std::size_t of_class, IdOf id_of,
                TakeWaiting& take_waiting) {
    int const first_row = tile.first_row + static_cast<int>(of_class / 3);
    int const first_column = tile.first_column + static_cast<int>(of_class % 3);
    if (first_row >= tile.end_row || first_column >= tile.end_column) return;
    auto const third = [](int cells) { return static_cast<std::size_t>((cells + 2) / 3); };
    make_room(size_ + third(tile.end_row - first_row) * third(tile.end_column - first_column) + 1);
    std::uint32_t* const rows = rows_.data();
    Block** const blocks = blocks_.data();
    std::uint8_t* const slots = slots_.data();
    Several* several = several_.data() + several_size_;
    std::size_t n = size_;
    for (int row = first_row; row < tile.end_row; row += 3) {
      Block* block = &grid.block_at(first_column, row);
      for (int column = first_column; column < tile.end_column; column += 3, block += 3) {
        unsigned waiting = 0;
        if (block->next == PackedGrid::none) [[likely]] {
          if ((block->marks & PackedGrid::changed) != 0) [[unlikely]] {
            note_order_of_ids(*block, id_of);
          }
          waiting = waiting_in_block.waiting[take_waiting(*block)];
          unsigned const slot = WaitingInBlock::slot(waiting, 0);
          rows[n] = block->agent[slot];
          blocks[n] = block;
          slots[n] = static_cast<std::uint8_t>(slot);
          *several = {static_cast<std::uint32_t>(n), waiting};
        } else {
          waiting = find_in_chain(grid, *block, id_of, take_waiting);
          if (waiting != 0) {
            rows[n] = chains_.back()[0];
            PackedGrid::Place const place = grid.place_of(rows[n]);
            blocks[n] = place.block;
            slots[n] = static_cast<std::uint8_t>(place.slot);
            *several = {static_cast<std::uint32_t>(n), is_chain | static_cast<std::uint32_t>(chains_.size() - 1)};
          }
        }
        static_assert(WaitingInBlock::several == 1U << 15 && WaitingInBlock::any == 1U << 14);
        several += waiting >> 15;
        n += waiting >> 14 & 1U;
      }
    }
    std::memset(tiles_.data() + size_, number, n - size_);
    several_size_ = static_cast<std::size_t>(several - several_.data());
    size_ = n;
  }

  /// Finds the waiting agents of a cell of several blocks, in the order of Ids. Returns the bits `any` and `several` of
  /// WaitingInBlock.
  template <class IdOf, class TakeWaiting>
  [[gnu::noinline]] unsigned find_in_chain(PackedGrid& grid, Block& first, IdOf id_of, TakeWaiting& take_waiting) {
    std::vector<std::uint32_t> rows;
    for (Block* block = &first;; block = &grid.next_of(*block)) {
      unsigned const taken = (1U << block->count) - 1U;
      for (unsigned left = take_waiting(*block) & taken; left != 0; left &= left - 1) {
        rows.push_back(block->agent[static_cast<std::size_t>(std::countr_zero(left))]);
      }
      if (block->next == PackedGrid::none) break;
    }
    if (rows.empty()) return 0;
    std::ranges::sort(rows, {}, id_of);
    chains_.push_back(std::move(rows));
    return WaitingInBlock::any | (chains_.back().size() > 1 ? WaitingInBlock::several : 0U);
  }

  /// Adds the second and later waiting agents of all cells, level by level.
  void add_levels() {
    std::size_t left = several_size_;
    for (unsigned level = 1; left > 0; ++level) {
      make_room(size_ + left);
      std::uint32_t* const rows = rows_.data();
      Block** const blocks = blocks_.data();
      std::uint32_t* const after = after_.data();
      std::uint8_t* const tiles = tiles_.data();
      Several* const several = several_.data();
      std::size_t n = size_;
      std::size_t kept = 0;
      for (std::size_t k = 0; k < left; ++k) {
        std::uint32_t const last = several[k].last;
        std::uint32_t const waiting = several[k].waiting;
        bool has_more = false;
        blocks[n] = blocks[last];
        if ((waiting & is_chain) == 0) [[likely]] {
          rows[n] = blocks[last]->agent[WaitingInBlock::slot(waiting, level)];
          has_more = WaitingInBlock::count(waiting) > level + 1;
        } else {
          std::vector<std::uint32_t> const& chain = chains_[waiting & ~is_chain];
          rows[n] = chain[level];
          has_more = chain.size() > level + 1;
        }
        after[n] = last;
        tiles[n] = tiles[last];
        several[kept] = {static_cast<std::uint32_t>(n), waiting};
        kept += has_more ? 1 : 0;
        ++n;
      }
      size_ = n;
      left = kept;
    }
  }

  std::size_t size_ = 0;
  std::size_t end_of_first_ = 0;  ///< end of the first level
  std::size_t several_size_ = 0;
  std::vector<std::uint32_t> rows_;
  std::vector<Block*> blocks_;
  std::vector<std::uint8_t> slots_;
  std::vector<std::uint8_t> tiles_;
  std::vector<std::uint32_t> after_;  ///< index of the turn before in the same cell; unused in the first level
  std::vector<Several> several_;
  std::vector<std::vector<std::uint32_t>> chains_;  ///< rows of waiting agents, for each cell of several blocks
};

}  // namespace gridlock
