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
///     of tiles:    │ 2  │ 3  │ 2  │ 3  │    The disks of a tile look at, hit and move to its own cells and the ring
///                  ├────┼────┼────┼────┤    of cells around it, so no disk is touched from two of them.
///                  │ 0  │ 1  │ 0  │ 1  │    Around a periodic box the number of tiles is even, or there is only one.
///                  └────┴────┴────┴────┘
///
/// A function of the cells alone, so that the order of the turns is one of the state alone.
class Tiling {
 public:
  struct Tile {
    int first_column, end_column;
    int first_row, end_row;
  };
  static constexpr std::size_t colours = 4;

  Tiling() = default;
  /// Tiles of about `cells_of_tile` cells a side, at least two; cuts are the same for the same cells.
  explicit Tiling(CellLayout const& layout, int cells_of_tile = 12);

  /// All tiles, colour by colour.
  [[nodiscard]] std::vector<Tile> const& tiles() const { return tiles_; }
  /// The tiles of a colour are first_of(colour) … first_of(colour + 1) − 1.
  [[nodiscard]] std::size_t first_of(std::size_t colour) const { return first_of_[colour]; }
  /// Tiles side by side, and one above the other.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::uint32_t number_of(std::size_t column, std::size_t row) const;
  /// Calls visit(number) for the tiles around one and for itself; around a small periodic box for some more than once.
  template <class Visit>
  void for_each_around(std::uint32_t tile, Visit visit) const {
    Place const place = place_of(tile);
    auto const near = [this](std::size_t at, std::size_t count, auto visit_at) {
      visit_at(at);
      if (at > 0 || is_periodic_) visit_at((at + count - 1) % count);
      if (at + 1 < count || is_periodic_) visit_at((at + 1) % count);
    };
    near(place.row, rows_, [&](std::size_t row) {
      near(place.column, columns_, [&](std::size_t column) { visit(number_of(column, row)); });
    });
  }

  /// Numbers of tiles, to be visited one after the other.
  using Part = std::vector<std::uint32_t>;
  /// A part has up to so many tiles of one colour one behind another: they may have their turns at once.
  static constexpr std::size_t tiles_of_team = 3;
  /// The first of these tiles, up to `most` of one colour.
  [[nodiscard]] std::span<std::uint32_t const> first_team(std::span<std::uint32_t const> tiles,
                                                          std::size_t most = tiles_of_team) const;
  /// Parts that may be carried out at once: no cell is touched from two of them.
  using Round = std::vector<Part>;
  /// All tiles, round after round, for a number of threads. Whatever that number, of two tiles that touch the same cell
  /// the one of the lower colour comes first, so that the result is the same as going colour by colour.
  ///
  /// The first round has a piece of the system for each part, several rows of tiles long, in which colours 2 and 3 of a
  /// row follow as soon as the rows of colours 0 and 1 on both sides are done: going colour by colour would bring all
  /// of a large system from memory four times. The tiles that must come after one of another piece are left to later
  /// rounds, colour by colour. In a small system, or for many threads, those are nearly all of colours 1 to 3.
  [[nodiscard]] std::vector<Round> rounds(std::size_t threads) const;

  /// A rectangle of tiles, which one of several processes takes care of.
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
  /// The rounds of the tiles of a rectangle, always as many as there are colours and some of them empty: after each of
  /// them the processes tell each other what they have changed. Tiles that must come after one of another process are
  /// left to later rounds.
  [[nodiscard]] std::vector<Round> rounds(Rectangle const& own, std::size_t threads) const;

 private:
  /// The piece of a tile that another process takes care of.
  static constexpr std::uint32_t elsewhere = 0xffff'ffff;

  /// Where a tile is among the tiles.
  struct Place {
    std::size_t column, row;
  };
  [[nodiscard]] Place place_of(std::uint32_t tile) const;
  [[nodiscard]] std::size_t colour_of(std::uint32_t tile) const;
  /// Whether is(other) for one of a lower colour among the eight around a tile.
  template <class Is>
  [[nodiscard]] bool any_before(std::uint32_t tile, Is is) const;
  /// The piece each tile is in: as many of those that are not elsewhere in each, row after row.
  [[nodiscard]] std::vector<std::uint32_t> pieces(Rectangle const& own, std::size_t threads) const;
  /// The first round, and for each colour what is left of it, in parts.
  [[nodiscard]] std::array<Round, colours + 1> rounds_of_colours(Rectangle const& own, std::size_t threads) const;
  /// Which tiles must come after a tile of another piece, or after one of these.
  [[nodiscard]] std::vector<bool> left_to_later_rounds(std::vector<std::uint32_t> const& piece) const;
  /// All tiles such that the order of colours is kept and a row is visited again soon.
  [[nodiscard]] Part in_order_of_memory() const;

  bool is_periodic_ = false;
  std::size_t columns_ = 0;
  std::size_t rows_ = 0;
  std::vector<Tile> tiles_;
  std::array<std::size_t, colours + 1> first_of_{};
};

}  // namespace gridlock
