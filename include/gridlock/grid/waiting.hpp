#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <span>
#include <vector>

#include "gridlock/grid/packed_grid.hpp"
#include "gridlock/grid/tiling.hpp"

namespace gridlock {

/// The agents of a tile that have not had their turn, in the order of their turns: class by class of cells three apart in
/// both directions, and in a class first the agents with the lowest Id of every cell, then the second lowest, …
///
///     classes    6 7 8 6 7 8     The agents of one class and one level have no neighbour in common, so their turns
///     of cells:  3 4 5 3 4 5     can be prepared together before any of them is taken.
///                0 1 2 0 1 2
///
/// Agents that come into a tile from another have had their turns, and those that have not stay where they are, so the
/// list made at the beginning stays right.
class Waiting {
 public:
  static constexpr std::size_t classes = 9;

  /// Finds those of the tile. `ids` are the Ids of all rows, or numbers in the same order, and behind them the largest
  /// number there is: that of a row of nobody, who never waits.
  template <class Number, class IsWaiting>
  void find(PackedGrid const& grid, Tiling::Tile const& tile, std::vector<Number> const& ids, IsWaiting is_waiting) {
    auto const third = [](int cells) { return static_cast<std::size_t>((cells + 2) / 3); };
    clear(third(tile.end_column - tile.first_column) * third(tile.end_row - tile.first_row));
    auto const nobody = static_cast<std::uint32_t>(ids.size() - 1);
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int column = tile.first_column; column < tile.end_column; ++column) {
        auto const of_class =
            static_cast<std::size_t>(3 * ((row - tile.first_row) % 3) + (column - tile.first_column) % 3);
        PackedGrid::Block const& block = grid.block_at(column, row);
        if (block.next == PackedGrid::none) {
          add_block(of_class, block, ids, nobody, is_waiting);
          continue;
        }
        std::vector<std::uint32_t> rows;
        for (PackedGrid::Block const* part = &block;; part = &grid.next_of(*part)) {
          std::copy_if(part->agent.begin(), part->agent.begin() + part->count, std::back_inserter(rows), is_waiting);
          if (part->next == PackedGrid::none) break;
        }
        std::ranges::sort(rows, {}, [&](std::uint32_t i) { return ids[i]; });
        add_sorted(of_class, rows);
      }
    }
  }

  [[nodiscard]] std::size_t size() const {
    std::size_t sum = 0;
    for (std::vector<Level> const& levels : classes_) {
      for (Level const& level : levels) sum += level.size;
    }
    return sum;
  }

  /// Calls visit(rows) for every class and level, in the order of the turns.
  template <class Visit>
  void for_each_group(Visit visit) const {
    for (std::vector<Level> const& levels : classes_) {
      for (Level const& level : levels) {
        if (level.size > 0) visit(std::span(level.rows).first(level.size));
      }
    }
  }

 private:
  void clear(std::size_t cells_of_class) {
    for (std::vector<Level>& levels : classes_) {
      for (Level& level : levels) {
        level.size = 0;
        if (level.rows.size() < cells_of_class + 1) level.rows.resize(cells_of_class + 1);
      }
      while (levels.size() < PackedGrid::slots)
        levels.push_back({.rows = std::vector<std::uint32_t>(cells_of_class + 1)});
    }
  }

  /// Adds the agents of a cell that fits one block. Which slots wait is as good as random, so nothing depends on it but
  /// what is written.
  template <class Number, class IsWaiting>
  void add_block(std::size_t of_class, PackedGrid::Block const& block, std::vector<Number> const& ids,
                 std::uint32_t nobody, IsWaiting is_waiting) {
    std::array<Number, PackedGrid::slots> id;
    std::array<std::uint32_t, PackedGrid::slots> row;
    std::size_t count = 0;
    for (std::uint32_t s = 0; s < PackedGrid::slots; ++s) {
      std::uint32_t const candidate = s < block.count ? block.agent[s] : nobody;
      bool const waits = is_waiting(candidate);
      row[s] = candidate;
      id[s] = ids[candidate] | (waits ? Number{0} : std::numeric_limits<Number>::max());
      count += waits ? 1 : 0;
    }
    auto const order = [&](std::size_t a, std::size_t b) {
      bool const is_wrong = id[b] < id[a];
      Number const low = is_wrong ? id[b] : id[a];
      id[b] = is_wrong ? id[a] : id[b];
      id[a] = low;
      std::uint32_t const low_row = is_wrong ? row[b] : row[a];
      row[b] = is_wrong ? row[a] : row[b];
      row[a] = low_row;
    };
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
    for (std::size_t n = 0; n < PackedGrid::slots; ++n) {
      Level& level = classes_[of_class][n];
      level.rows[level.size] = row[n];
      level.size += n < count ? 1 : 0;
    }
  }

  /// Adds the agents of a cell of any size, in the order of their Ids.
  void add_sorted(std::size_t of_class, std::span<std::uint32_t const> rows) {
    std::vector<Level>& levels = classes_[of_class];
    while (levels.size() < rows.size()) levels.push_back({.rows = std::vector<std::uint32_t>(levels[0].rows.size())});
    for (std::size_t n = 0; n < rows.size(); ++n) levels[n].rows[levels[n].size++] = rows[n];
  }

  struct Level {
    std::vector<std::uint32_t> rows;  ///< one more than can be, for what is written and not meant
    std::size_t size = 0;
  };
  std::array<std::vector<Level>, classes> classes_;
};

}  // namespace gridlock
