#include "gridlock/grid/tiling.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>

namespace gridlock {

namespace {

/// Where the tiles along one side begin; the last entry is the end.
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
  std::vector<int> const columns = cuts(layout.columns(), cells_of_tile, layout.is_periodic());
  std::vector<int> const rows = cuts(layout.rows(), cells_of_tile, layout.is_periodic());
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
  // Several parts for each thread, so that none waits long for the last one.
  constexpr std::size_t parts_of_thread = 4;
  std::size_t const even_rows = (rows_ + 1) / 2;
  if (threads == 1) return rounds_by_band(1);
  if (even_rows >= 2 * parts_of_thread * threads) return rounds_by_band(parts_of_thread * threads);
  return rounds_by_colour(threads);
}

std::uint32_t Tiling::number_of(std::size_t column, std::size_t row) const {
  std::size_t const in_row = (columns_ + 1 - column % 2) / 2;
  return static_cast<std::uint32_t>(first_of_[2 * (row % 2) + column % 2] + row / 2 * in_row + column / 2);
}

void Tiling::add_row(std::size_t row, Part& part) const {
  for (std::size_t column = 0; column < columns_; column += 2) {
    part.push_back(number_of(column, row));
    if (column > 0) part.push_back(number_of(column - 1, row));
  }
  if (columns_ % 2 == 0) part.push_back(number_of(columns_ - 1, row));
}

std::vector<Tiling::Round> Tiling::rounds_by_colour(std::size_t threads) const {
  std::vector<Round> all(colours);
  for (std::size_t colour = 0; colour < colours; ++colour) {
    std::size_t const first = first_of_[colour];
    std::size_t const count = first_of_[colour + 1] - first;
    std::size_t const parts = std::min(count, 8 * threads);
    for (std::size_t part = 0; part < parts; ++part) {
      Part& tiles = all[colour].emplace_back();
      for (std::size_t tile = first + count * part / parts; tile < first + count * (part + 1) / parts; ++tile) {
        tiles.push_back(static_cast<std::uint32_t>(tile));
      }
    }
  }
  return all;
}

std::vector<Tiling::Round> Tiling::rounds_by_band(std::size_t bands) const {
  std::size_t const even_rows = (rows_ + 1) / 2;
  std::vector<Round> all(2);
  for (std::size_t band = 0; band < bands; ++band) {
    std::size_t const first = even_rows * band / bands;
    std::size_t const end = even_rows * (band + 1) / bands;
    Part& inside = all[0].emplace_back();
    for (std::size_t k = first; k < end; ++k) {
      add_row(2 * k, inside);
      if (k > first) add_row(2 * k - 1, inside);
    }
    if (2 * end - 1 < rows_) add_row(2 * end - 1, all[1].emplace_back());
  }
  return all;
}

}  // namespace gridlock
