#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/grid/cell_layout.hpp"

namespace gridlock {

/// The cells of a grid in tiles, coloured so that tiles of one colour can take their turns at the same time.
///
///     colours      ┌────┬────┬────┬────┐    Between two tiles of colour 0 lies a whole tile, at least two cells wide.
///     of tiles:    │ 2  │ 3  │ 2  │ 3  │    The disks of a tile read, hit and move to its own cells and the ring
///                  ├────┼────┼────┼────┤    of cells around it, so no disk is touched from two of them.
///                  │ 0  │ 1  │ 0  │ 1  │    Along a periodic axis the number of tiles is even, or there is only one.
///                  └────┴────┴────┴────┘
///
/// The tiles depend on the cells alone, so that the order of turns depends on the state alone.
class Tiling {
 public:
  struct Tile {
    int first_column, end_column;
    int first_row, end_row;
  };
  static constexpr std::size_t colours = 4;

  Tiling() = default;
  /// Makes tiles of about `cells_of_tile` cells a side, at least two.
  explicit Tiling(CellLayout const& layout, int cells_of_tile = 12);

  /// Returns all tiles, colour by colour.
  [[nodiscard]] std::vector<Tile> const& tiles() const { return tiles_; }
  /// Returns the number of the first tile of a colour; the last is first_of(colour + 1) − 1.
  [[nodiscard]] std::size_t first_of(std::size_t colour) const { return first_of_[colour]; }
  /// Return the number of columns and of rows of tiles.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::uint32_t number_of(std::size_t column, std::size_t row) const;
  /// Calls visit(number) for a tile and the tiles around it; in a small periodic box for some tiles more than once.
  template <class Visit>
  void for_each_around(std::uint32_t tile, Visit visit) const {
    Place const place = place_of(tile);
    auto const near = [](std::size_t at, std::size_t count, bool is_periodic, auto visit_at) {
      visit_at(at);
      if (at > 0 || is_periodic) visit_at((at + count - 1) % count);
      if (at + 1 < count || is_periodic) visit_at((at + 1) % count);
    };
    near(place.row, rows_, is_periodic_y_, [&](std::size_t row) {
      near(place.column, columns_, is_periodic_x_, [&](std::size_t column) { visit(number_of(column, row)); });
    });
  }

  /// Numbers of tiles, which one thread takes one after the other.
  using Part = std::vector<std::uint32_t>;
  /// The most tiles of one colour, one behind another in a part, whose turns are computed together.
  static constexpr std::size_t tiles_of_team = 3;
  /// Returns the first of `tiles` that have the same colour, at most `most`.
  [[nodiscard]] std::span<std::uint32_t const> first_team(std::span<std::uint32_t const> tiles,
                                                          std::size_t most = tiles_of_team) const;
  /// Parts that threads may take at the same time: no cell is touched by two of them.
  using Round = std::vector<Part>;
  /// Returns all tiles, round after round, for a number of threads. Of two tiles that touch the same cell the one of
  /// the lower colour always comes first, so that results do not depend on the number of threads.
  ///
  /// In the first round each part is a piece of several rows of tiles. Colours 2 and 3 of a row follow as soon as the
  /// rows of colours 0 and 1 on both sides are done, since going colour by colour would read a large system from memory
  /// four times. Tiles that must come after a tile of another piece are left to later rounds, one for each colour. In a
  /// small system, or for many threads, these are nearly all tiles of colours 1 to 3.
  [[nodiscard]] std::vector<Round> rounds(std::size_t threads) const;

  /// A rectangle of tiles, which one of several processes owns.
  struct Rectangle {
    std::size_t first_column = 0, end_column = 0;
    std::size_t first_row = 0, end_row = 0;

    [[nodiscard]] std::size_t tiles() const { return (end_column - first_column) * (end_row - first_row); }
    /// Calls visit(column, row) for each tile.
    template <class Visit>
    void for_each_tile(Visit visit) const {
      for (std::size_t row = first_row; row < end_row; ++row) {
        for (std::size_t column = first_column; column < end_column; ++column) visit(column, row);
      }
    }
  };
  /// Returns the rounds of the tiles of a rectangle, one for each colour; some may be empty. After each round processes
  /// exchange the cells that they have changed. Tiles that must come after a tile of another process are left to later
  /// rounds.
  [[nodiscard]] std::vector<Round> rounds(Rectangle const& own, std::size_t threads) const;

 private:
  /// The piece number of a tile that another process owns.
  static constexpr std::uint32_t elsewhere = 0xffff'ffff;

  struct Place {
    std::size_t column, row;
  };
  [[nodiscard]] Place place_of(std::uint32_t tile) const;
  [[nodiscard]] std::size_t colour_of(std::uint32_t tile) const;
  /// Returns whether is(other) holds for a tile of a lower colour among the eight tiles around a tile.
  template <class Is>
  [[nodiscard]] bool any_before(std::uint32_t tile, Is is) const;
  /// Returns the piece of each tile: pieces have equal numbers of own tiles, row after row.
  [[nodiscard]] std::vector<std::uint32_t> pieces(Rectangle const& own, std::size_t threads) const;
  /// Returns the first round, and then for each colour a round of its remaining tiles.
  [[nodiscard]] std::array<Round, colours + 1> rounds_of_colours(Rectangle const& own, std::size_t threads) const;
  /// Returns for each tile whether it must come after a tile of another piece, or after a tile that must.
  [[nodiscard]] std::vector<bool> left_to_later_rounds(std::vector<std::uint32_t> const& piece) const;
  /// Returns all tiles in an order that keeps the order of colours and visits a row again soon, while it is in the
  /// cache.
  [[nodiscard]] Part in_order_of_memory() const;

  bool is_periodic_x_ = false;
  bool is_periodic_y_ = false;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<Tile> tiles_;
  std::array<std::size_t, colours + 1> first_of_{};
};

}  // namespace gridlock
