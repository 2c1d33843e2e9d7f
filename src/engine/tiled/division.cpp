#include "engine/tiled/division.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gridlock::tiled {

namespace {

/// Where to cut a row of weights so that piece k has about shares[k] of their sum; the last entry is the end. While there
/// are enough weights each piece has at least one.
std::vector<std::size_t> cuts(std::span<std::uint64_t const> weights, std::span<std::size_t const> shares) {
  std::size_t const pieces = shares.size();
  auto const sum = static_cast<double>(std::reduce(weights.begin(), weights.end()));
  auto const all_shares = static_cast<double>(std::reduce(shares.begin(), shares.end()));
  std::vector<std::size_t> at(pieces + 1, 0);
  at[pieces] = weights.size();
  double so_far = 0.0;
  std::size_t shares_so_far = 0;
  std::size_t n = 0;
  for (std::size_t k = 1; k < pieces; ++k) {
    shares_so_far += shares[k - 1];
    double const goal = sum * static_cast<double>(shares_so_far) / all_shares;
    // The middle of a weight decides on which side of the cut it is.
    while (n < weights.size() && so_far + 0.5 * static_cast<double>(weights[n]) < goal) {
      so_far += static_cast<double>(weights[n++]);
    }
    std::size_t const left = pieces - k;
    std::size_t const most = weights.size() > left ? weights.size() - left : 0;
    at[k] =
        std::max(at[k - 1], std::clamp(n, std::min(k, weights.size()), std::max(most, std::min(k, weights.size()))));
    for (; n < at[k]; ++n) so_far += static_cast<double>(weights[n]);
  }
  return at;
}

/// The numbers of columns or rows of a side that lie in both ranges, each of which may go around the box.
std::vector<int> common(int first, int end, int other_first, int other_end, int all) {
  std::vector<int> both;
  for (int k = first; k < end; ++k) {
    int const index = (k % all + all) % all;
    // Images of it in the other range.
    int const image = other_first + ((index - other_first) % all + all) % all;
    if (image < other_end) both.push_back(index);
  }
  return both;
}

}  // namespace

std::vector<Tiling::Rectangle> divide(Tiling const& tiling, std::span<std::uint64_t const> disks, std::size_t ranks) {
  std::size_t const columns = tiling.columns();
  std::size_t const rows = tiling.rows();
  // An empty tile is work, too.
  auto const weight_of = [&](std::size_t column, std::size_t row) { return disks[tiling.number_of(column, row)] + 1; };
  double const shape = static_cast<double>(rows) / static_cast<double>(columns);
  auto const strips = static_cast<std::size_t>(std::clamp(std::round(std::sqrt(static_cast<double>(ranks) * shape)),
                                                          1.0, static_cast<double>(std::min(ranks, rows))));
  std::vector<std::size_t> ranks_of_strip(strips);
  for (std::size_t k = 0; k < strips; ++k) ranks_of_strip[k] = ranks * (k + 1) / strips - ranks * k / strips;
  std::vector<std::uint64_t> weights(rows, 0);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) weights[row] += weight_of(column, row);
  }
  std::vector<std::size_t> const row_cuts = cuts(weights, ranks_of_strip);
  std::vector<Tiling::Rectangle> rectangles;
  for (std::size_t strip = 0; strip < strips; ++strip) {
    weights.assign(columns, 0);
    for (std::size_t column = 0; column < columns; ++column) {
      for (std::size_t row = row_cuts[strip]; row < row_cuts[strip + 1]; ++row) {
        weights[column] += weight_of(column, row);
      }
    }
    std::vector<std::size_t> const ones(ranks_of_strip[strip], 1);
    std::vector<std::size_t> const column_cuts = cuts(weights, ones);
    for (std::size_t k = 0; k < ones.size(); ++k) {
      rectangles.push_back({.first_column = column_cuts[k],
                            .end_column = column_cuts[k + 1],
                            .first_row = row_cuts[strip],
                            .end_row = row_cuts[strip + 1]});
    }
  }
  return rectangles;
}

CellWindow within(CellLayout const& layout, CellWindow window) {
  auto const cut = [&](int& begin, int& end, int all) {
    if (!layout.is_periodic()) {
      begin = std::max(0, begin);
      end = std::min(all, end);
    } else if (end - begin >= all) {
      begin = 0;
      end = all;
    }
  };
  cut(window.first_column, window.end_column, layout.columns());
  cut(window.first_row, window.end_row, layout.rows());
  return window;
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

}  // namespace gridlock::tiled
