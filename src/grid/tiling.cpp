#include "gridlock/grid/detail/tiling.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <span>

namespace gridlock {

namespace {

/// Returns where the tiles along one side begin; the last entry is the end.
std::vector<int> cuts(int cells, int cells_of_tile, bool is_periodic) {
  int count = std::max(1, cells / cells_of_tile);
  if (is_periodic && count > 1) count -= count % 2;
  std::vector<int> at;
  for (int tile = 0; tile <= count; ++tile) {
    at.push_back(static_cast<int>(std::int64_t{cells} * tile / count));
  }
  return at;
}

}  // namespace

Tiling::Tiling(CellLayout const& layout, int cells_of_tile) {
  assert(cells_of_tile >= 2);
  std::vector<int> const columns = cuts(layout.columns(), cells_of_tile, layout.is_periodic_x());
  std::vector<int> const rows = cuts(layout.rows(), cells_of_tile, layout.is_periodic_y());
  is_periodic_x_ = layout.is_periodic_x();
  is_periodic_y_ = layout.is_periodic_y();
  columns_ = columns.size() - 1;
  rows_ = rows.size() - 1;
  for (std::size_t colour = 0; colour < colours; ++colour) {
    first_of_[colour] = tiles_.size();
    for (std::size_t r = colour / 2; r + 1 < rows.size(); r += 2) {
      for (std::size_t c = colour % 2; c + 1 < columns.size(); c += 2) {
        tiles_.push_back(
            {.first_column = columns[c], .end_column = columns[c + 1], .first_row = rows[r], .end_row = rows[r + 1]});
      }
    }
  }
  first_of_[colours] = tiles_.size();
}

std::vector<Tiling::Round> Tiling::rounds(std::size_t threads) const {
  std::vector<Round> all;
  for (Round& round : rounds_of_colours({.end_column = columns_, .end_row = rows_}, threads)) {
    if (!round.empty()) all.push_back(std::move(round));
  }
  return all;
}

std::vector<Tiling::Round> Tiling::rounds(Rectangle const& own, std::size_t threads) const {
  auto [first, none, second, third, fourth] = rounds_of_colours(own, threads);
  assert(none.empty());  // no tile must precede those of colour 0, so none of them is left for a later round
  return {std::move(first), std::move(second), std::move(third), std::move(fourth)};
}

std::array<Tiling::Round, Tiling::colours + 1> Tiling::rounds_of_colours(Rectangle const& own,
                                                                         std::size_t threads) const {
  std::array<Round, colours + 1> all;
  if (own.tiles() == 0) return all;
  std::vector<std::uint32_t> const piece = pieces(own, threads);
  std::vector<bool> const is_left = left_to_later_rounds(piece);
  std::array<Part, colours> left;
  for (std::uint32_t const tile : in_order_of_memory()) {
    if (piece[tile] == elsewhere) continue;
    if (is_left[tile]) {
      left[colour_of(tile)].push_back(tile);
    } else {
      if (all[0].size() <= piece[tile]) all[0].resize(piece[tile] + std::size_t{1});
      all[0][piece[tile]].push_back(tile);
    }
  }
  for (std::size_t colour = 0; colour < colours; ++colour) {
    Part const& tiles = left[colour];
    std::size_t const parts = std::min(tiles.size(), 4 * threads);
    for (std::size_t part = 0; part < parts; ++part) {
      auto const at = [&](std::size_t k) {
        return tiles.begin() + static_cast<std::ptrdiff_t>(tiles.size() * k / parts);
      };
      all[colour + 1].emplace_back(at(part), at(part + 1));
    }
  }
  return all;
}

std::span<std::uint32_t const> Tiling::first_team(std::span<std::uint32_t const> tiles, std::size_t most) const {
  std::size_t count = 0;
  for (most = std::min(tiles.size(), most); count < most; ++count) {
    if (colour_of(tiles[count]) != colour_of(tiles[0])) break;
  }
  return tiles.first(count);
}

std::uint32_t Tiling::number_of(std::size_t column, std::size_t row) const {
  std::size_t const in_row = (columns_ + 1 - column % 2) / 2;
  return static_cast<std::uint32_t>(first_of_[2 * (row % 2) + column % 2] + row / 2 * in_row + column / 2);
}

Tiling::Place Tiling::place_of(std::uint32_t tile) const {
  std::size_t const colour = colour_of(tile);
  std::size_t const in_row = (columns_ + 1 - colour % 2) / 2;
  std::size_t const n = tile - first_of_[colour];
  return {.column = 2 * (n % in_row) + colour % 2, .row = 2 * (n / in_row) + colour / 2};
}

std::size_t Tiling::colour_of(std::uint32_t tile) const {
  std::size_t colour = 0;
  while (tile >= first_of_[colour + 1]) ++colour;
  return colour;
}

std::vector<std::uint32_t> Tiling::pieces(Rectangle const& own, std::size_t threads) const {
  // Each thread gets several pieces, so that none waits long for the last, but pieces of many rows.
  constexpr std::size_t max_pieces_of_thread = 4;
  constexpr std::size_t rows_of_piece = 8;
  std::size_t const columns = own.end_column - own.first_column;
  std::size_t const rows = own.end_row - own.first_row;
  std::size_t const tiles = own.tiles();
  std::size_t const count =
      threads == 1 ? 1 : threads * std::clamp<std::size_t>(rows / (rows_of_piece * threads), 1, max_pieces_of_thread);
  std::vector<std::uint32_t> piece(tiles_.size(), elsewhere);
  auto const tile_at = [&](std::size_t n) {
    return number_of(own.first_column + n % columns, own.first_row + n / columns);
  };
  if (count == 1) {
    for (std::size_t n = 0; n < tiles; ++n) piece[tile_at(n)] = 0;
    return piece;
  }
  // Divides the tiles row after row. Tiles that must wait for later rounds lie at the cuts, so the cuts are moved until
  // every piece has as much to do in the first round.
  std::vector<std::size_t> cut(count + 1);
  for (std::size_t k = 0; k <= count; ++k) cut[k] = tiles * k / count;
  for (int attempt = 0; attempt < 8; ++attempt) {
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t n = cut[k]; n < cut[k + 1]; ++n) piece[tile_at(n)] = static_cast<std::uint32_t>(k);
    }
    std::vector<bool> const is_left = left_to_later_rounds(piece);
    std::vector<std::size_t> inside(count, 0);
    for (std::size_t n = 0; n < tiles; ++n) inside[piece[tile_at(n)]] += is_left[tile_at(n)] ? 0 : 1;
    auto const all_inside = static_cast<double>(std::reduce(inside.begin(), inside.end()));
    double so_far = 0.0;
    for (std::size_t k = 1; k < count; ++k) {
      so_far += static_cast<double>(inside[k - 1]);
      double const too_many = so_far - all_inside * static_cast<double>(k) / static_cast<double>(count);
      double const at = static_cast<double>(cut[k]) - 0.5 * too_many;
      cut[k] = std::clamp(static_cast<std::size_t>(std::max(0.0, at)), cut[k - 1], tiles);
    }
  }
  return piece;
}

template <class Is>
bool Tiling::any_before(std::uint32_t tile, Is is) const {
  std::size_t const first_of_colour = first_of_[colour_of(tile)];
  bool is_any = false;
  for_each_around(tile, [&](std::uint32_t other) { is_any = is_any || (other < first_of_colour && is(other)); });
  return is_any;
}

std::vector<bool> Tiling::left_to_later_rounds(std::vector<std::uint32_t> const& piece) const {
  std::vector<bool> is_left(tiles_.size(), false);
  // Tiles are numbered colour by colour. A tile that must follow a tile of a later round is in a later round too.
  for (std::uint32_t tile = 0; tile < tiles_.size(); ++tile) {
    is_left[tile] =
        any_before(tile, [&](std::uint32_t before) { return is_left[before] || piece[before] != piece[tile]; });
  }
  return is_left;
}

Tiling::Part Tiling::in_order_of_memory() const {
  Part order;
  order.reserve(tiles_.size());
  // Every second tile of a few goes first, then the tiles between them.
  auto const add_row = [&](std::size_t row) {
    std::size_t between = 1;
    for (std::size_t column = 0; column < columns_; column += 2) {
      order.push_back(number_of(column, row));
      bool const is_last = column + 2 >= columns_;
      if (!is_last && column / 2 % tiles_of_team != tiles_of_team - 1) continue;
      for (; between < columns_ && (between < column || is_last); between += 2)
        order.push_back(number_of(between, row));
    }
  };
  for (std::size_t row = 0; row < rows_; row += 2) {
    add_row(row);
    if (row > 0) add_row(row - 1);
  }
  if (rows_ % 2 == 0) add_row(rows_ - 1);
  return order;
}

}  // namespace gridlock
