#include "gridlock/grid/detail/tiling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridlock {
namespace {

/// The tile each cell is in, or −1; fails where a cell is in two.
std::vector<int> owners(CellLayout const& layout, Tiling const& tiling) {
  std::vector<int> owner(static_cast<std::size_t>(layout.count()), -1);
  for (std::size_t t = 0; t < tiling.tiles().size(); ++t) {
    Tiling::Tile const& tile = tiling.tiles()[t];
    for (int row = tile.first_row; row < tile.end_row; ++row) {
      for (int column = tile.first_column; column < tile.end_column; ++column) {
        int& cell = owner[static_cast<std::size_t>(row * layout.columns() + column)];
        EXPECT_EQ(cell, -1) << column << ", " << row;
        cell = static_cast<int>(t);
      }
    }
  }
  return owner;
}

class TilingOf : public testing::TestWithParam<Edge> {};

TEST_P(TilingOf, EveryNumberOfCellsHasEachCellInOneTile) {
  for (int columns : {1, 2, 3, 5, 11, 12, 13, 24, 25, 35, 36, 37, 100}) {
    for (int rows : {1, 3, 12, 23, 24, 49}) {
      CellLayout const layout(Box(1.0, 2.0, GetParam()), columns, rows);
      for (int const owner : owners(layout, Tiling(layout))) ASSERT_GE(owner, 0) << columns << " × " << rows;
    }
  }
}

/// Two tiles of one colour have no cell in common even when each grows by the ring of cells around it.
TEST_P(TilingOf, TilesOfOneColourNeverTouchTheSameCell) {
  for (int columns : {1, 2, 3, 4, 5, 7, 12, 24, 25, 36, 37, 50}) {
    for (int rows : {1, 2, 3, 6, 25, 48}) {
      for (int const size : {2, 3, 12}) {
        CellLayout const layout(Box(1.0, 1.0, GetParam()), columns, rows);
        Tiling const tiling(layout, size);
        for (std::size_t colour = 0; colour < Tiling::colours; ++colour) {
          std::vector<int> touched(static_cast<std::size_t>(layout.count()), -1);
          for (std::size_t t = tiling.first_of(colour); t < tiling.first_of(colour + 1); ++t) {
            Tiling::Tile const& tile = tiling.tiles()[t];
            for (int row = tile.first_row; row < tile.end_row; ++row) {
              for (int column = tile.first_column; column < tile.end_column; ++column) {
                layout.for_each_cell_in_block(row * columns + column, 1, 1, [&](int cell) {
                  int& by = touched[static_cast<std::size_t>(cell)];
                  ASSERT_TRUE(by == -1 || by == static_cast<int>(t))
                      << columns << " × " << rows << " cells, tiles of " << size << ", colour " << colour;
                  by = static_cast<int>(t);
                });
              }
            }
          }
        }
      }
    }
  }
}

/// When each tile is visited, and where.
struct Turn {
  std::size_t round, part, place;
};

/// Tiles that touch the same cell, itself included, for every cell.
std::vector<std::vector<std::size_t>> tiles_at_cells(CellLayout const& layout, Tiling const& tiling) {
  std::vector<std::vector<std::size_t>> at(static_cast<std::size_t>(layout.count()));
  std::vector<int> const owner = owners(layout, tiling);
  for (int cell = 0; cell < layout.count(); ++cell) {
    auto& tiles = at[static_cast<std::size_t>(cell)];
    layout.for_each_cell_in_block(cell, 1, 1, [&](int c) {
      auto const tile = static_cast<std::size_t>(owner[static_cast<std::size_t>(c)]);
      if (std::ranges::find(tiles, tile) == tiles.end()) tiles.push_back(tile);
    });
  }
  return at;
}

/// Fails unless every tile is in `rounds` once, and of two tiles that touch the same cell the one of the lower colour
/// comes before the other: in an earlier round, or earlier in the same part.
void expect_order_of_colours(CellLayout const& layout, Tiling const& tiling, std::vector<Tiling::Round> const& rounds) {
  std::vector<Turn> turn(tiling.tiles().size());
  std::vector<int> visits(turn.size(), 0);
  for (std::size_t r = 0; r < rounds.size(); ++r) {
    for (std::size_t p = 0; p < rounds[r].size(); ++p) {
      for (std::size_t k = 0; k < rounds[r][p].size(); ++k) {
        ++visits[rounds[r][p][k]];
        turn[rounds[r][p][k]] = {r, p, k};
      }
    }
  }
  for (int const n : visits) ASSERT_EQ(n, 1);
  // Tiles are numbered colour by colour, and tiles of one colour never touch the same cell: see above.
  for (std::vector<std::size_t> const& tiles : tiles_at_cells(layout, tiling)) {
    for (std::size_t const a : tiles) {
      for (std::size_t const b : tiles) {
        if (a >= b) continue;
        bool const is_before =
            turn[a].round < turn[b].round ||
            (turn[a].round == turn[b].round && turn[a].part == turn[b].part && turn[a].place < turn[b].place);
        ASSERT_TRUE(is_before) << layout.columns() << " × " << layout.rows() << ", tiles " << a << " and " << b;
      }
    }
  }
}

TEST_P(TilingOf, RoundsForAnyNumberOfThreadsKeepTheOrderOfColours) {
  for (int columns : {1, 2, 5, 8, 9, 13, 24}) {
    for (int rows : {1, 2, 4, 7, 33, 66, 131}) {
      for (int const size : {2, 3}) {
        CellLayout const layout(Box(1.0, 1.0, GetParam()), columns, rows);
        Tiling const tiling(layout, size);
        for (std::size_t const threads : {1, 2, 3}) {
          SCOPED_TRACE(threads);
          ASSERT_NO_FATAL_FAILURE(expect_order_of_colours(layout, tiling, tiling.rounds(threads)));
        }
      }
    }
  }
}

TEST_P(TilingOf, TeamsAreOfOneColourAndMostOfThemAreFull) {
  Tiling const tiling(CellLayout(Box(1.0, 1.0, GetParam()), 500, 400));
  auto const colour_of = [&](std::uint32_t tile) {
    std::size_t colour = 0;
    while (tile >= tiling.first_of(colour + 1)) ++colour;
    return colour;
  };
  for (std::size_t const threads : {1, 2}) {
    std::size_t teams = 0;
    std::size_t tiles = 0;
    for (Tiling::Round const& round : tiling.rounds(threads)) {
      for (Tiling::Part const& part : round) {
        std::span<std::uint32_t const> rest = part;
        while (!rest.empty()) {
          std::span<std::uint32_t const> const team = tiling.first_team(rest);
          ASSERT_GE(team.size(), 1U);
          ASSERT_LE(team.size(), Tiling::tiles_of_team);
          ASSERT_EQ(team.data(), rest.data());
          for (std::uint32_t const tile : team) ASSERT_EQ(colour_of(tile), colour_of(team[0]));
          for (std::size_t const most : {1U, 2U}) {
            ASSERT_EQ(tiling.first_team(rest, most).size(), std::min(team.size(), most));
            ASSERT_EQ(tiling.first_team(rest, most).data(), rest.data());
          }
          rest = rest.subspan(team.size());
          ++teams;
          tiles += team.size();
        }
      }
    }
    EXPECT_EQ(tiles, tiling.tiles().size());
    EXPECT_LT(teams, tiles / 2) << threads << " threads";
  }
  EXPECT_TRUE(tiling.first_team({}).empty());
}

std::size_t tiles_of(Tiling::Round const& round) {
  std::size_t sum = 0;
  for (Tiling::Part const& part : round) sum += part.size();
  return sum;
}

std::size_t longest_part(Tiling::Round const& round) { return std::ranges::max(round, {}, &Tiling::Part::size).size(); }

TEST_P(TilingOf, OneThreadVisitsAllTilesInOneRound) {
  std::vector<Tiling::Round> const rounds = Tiling(CellLayout(Box(1.0, 1.0, GetParam()), 90, 70)).rounds(1);
  ASSERT_EQ(rounds.size(), 1U);
  EXPECT_EQ(rounds[0].size(), 1U);
}

TEST_P(TilingOf, LargeSystemsAreDoneNearlyWhollyInTheFirstRound) {
  Tiling const tiling(CellLayout(Box(1.0, 1.0, GetParam()), 60 * 12, 60 * 12));
  std::vector<Tiling::Round> const rounds = tiling.rounds(2);
  // What is left is a row of colours 2 and 3 at each cut between two of 6 pieces, and few tiles of colour 1.
  EXPECT_GE(tiles_of(rounds[0]), tiling.tiles().size() * 85 / 100);
}

TEST_P(TilingOf, TwoThreadsHaveTheSameToDo) {
  for (int const side : {7, 8, 13, 22, 30, 69}) {
    SCOPED_TRACE(side);
    Tiling const tiling(CellLayout(Box(1.0, 1.0, GetParam()), 12 * side, 12 * side));
    std::vector<Tiling::Round> const rounds = tiling.rounds(2);
    std::size_t const fair_share = (tiles_of(rounds[0]) + rounds[0].size() - 1) / rounds[0].size();
    EXPECT_LE(longest_part(rounds[0]), fair_share + 2 + fair_share / 100);
    for (Tiling::Round const& round : std::span(rounds).subspan(1)) {
      EXPECT_LE(longest_part(round), (tiles_of(round) + 1) / 2);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Edges, TilingOf, testing::Values(Edge::wall, Edge::periodic),
                         [](auto const& edge) { return edge.param == Edge::wall ? "walls" : "periodic"; });

}  // namespace
}  // namespace gridlock
