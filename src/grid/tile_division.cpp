#include "gridlock/grid/detail/tile_division.hpp"

#include "grid/division.hpp"

namespace gridlock {

namespace {

/// Returns the columns or rows that lie in both ranges, each of which may go around the box.
std::vector<int> common(int first, int end, int other_first, int other_end, int all) {
  std::vector<int> both;
  for (int k = first; k < end; ++k) {
    int const index = (k % all + all) % all;
    // The first image of it at or after the start of the other range.
    int const image = other_first + ((index - other_first) % all + all) % all;
    if (image < other_end) both.push_back(index);
  }
  return both;
}

/// Returns the column or row of tiles for each column or row of cells; end_of(tile) is where a tile ends.
template <class EndOf>
std::vector<std::size_t> tiles_of_cells(std::size_t tiles, EndOf end_of) {
  std::vector<std::size_t> tile_of_cell;
  for (std::size_t k = 0; k < tiles; ++k) tile_of_cell.resize(static_cast<std::size_t>(end_of(k)), k);
  return tile_of_cell;
}

}  // namespace

std::vector<Tiling::Rectangle> divide_tiles(Tiling const& tiling, std::span<std::uint64_t const> agents,
                                            std::size_t parts) {
  std::size_t const columns = tiling.columns();
  std::size_t const rows = tiling.rows();
  // An empty tile takes work too, so its weight is 1.
  auto const weight_of = [&](std::size_t column, std::size_t row) { return agents[tiling.number_of(column, row)] + 1; };
  std::vector<std::uint64_t> weights(rows, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) weights[row] += weight_of(column, row);
  }
  double const shape = static_cast<double>(rows) / static_cast<double>(columns);
  return divide(weights, shape, parts, [&](std::size_t first_row, std::size_t end_row) {
    std::vector<std::uint64_t> of_columns(columns, 0);
    for (std::size_t column = 0; column < columns; ++column) {
      for (std::size_t row = first_row; row < end_row; ++row) of_columns[column] += weight_of(column, row);
    }
    return of_columns;
  });
}

CellWindow window_around(CellLayout const& layout, Tiling const& tiling, Tiling::Rectangle const& rectangle,
                         int margin) {
  if (rectangle.tiles() == 0) return {};
  Tiling::Tile const& first = tiling.tiles()[tiling.number_of(rectangle.first_column, rectangle.first_row)];
  Tiling::Tile const& last = tiling.tiles()[tiling.number_of(rectangle.end_column - 1, rectangle.end_row - 1)];
  return within(layout, {.first_column = first.first_column - margin,
                         .end_column = last.end_column + margin,
                         .first_row = first.first_row - margin,
                         .end_row = last.end_row + margin});
}

CellWindow window_around(CellLayout const& layout, Tiling::Tile const& tile, int margin) {
  return within(layout, {.first_column = tile.first_column - margin,
                         .end_column = tile.end_column + margin,
                         .first_row = tile.first_row - margin,
                         .end_row = tile.end_row + margin});
}

bool overlap(CellLayout const& layout, CellWindow const& one, CellWindow const& other) {
  return !common(one.first_column, one.end_column, other.first_column, other.end_column, layout.columns()).empty() &&
         !common(one.first_row, one.end_row, other.first_row, other.end_row, layout.rows()).empty();
}

std::vector<int> common_cells(CellLayout const& layout, CellWindow const& one, CellWindow const& other) {
  std::vector<int> const columns =
      common(one.first_column, one.end_column, other.first_column, other.end_column, layout.columns());
  std::vector<int> cells;
  for (int const row : common(one.first_row, one.end_row, other.first_row, other.end_row, layout.rows())) {
    for (int const column : columns) cells.push_back(row * layout.columns() + column);
  }
  return cells;
}

TileFinder::TileFinder(CellLayout const& layout, Tiling const& tiling)
    : layout_(layout),
      tiling_(tiling),
      column_of_(tiles_of_cells(tiling.columns(),
                                [&](std::size_t k) { return tiling.tiles()[tiling.number_of(k, 0)].end_column; })),
      row_of_(tiles_of_cells(tiling.rows(),
                             [&](std::size_t k) { return tiling.tiles()[tiling.number_of(0, k)].end_row; })) {}

}  // namespace gridlock
