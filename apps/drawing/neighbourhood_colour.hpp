#pragma once

namespace gridlock {

/// How many colours neighbourhood_colour() hands out.
inline constexpr int neighbourhood_colours = 9;

/// The colour of a cell, such that no two of the eight cells around a cell and the cell itself share one.
///
///     0 1 0 1        three colours along an axis where a periodic edge        0 1 2
///     3 4 3 4        brings an odd number of cells round                      3 4 5
///     0 1 0 1                                                                 6 7 8
///
/// Neighbours differ by one in column or row, so it is enough that consecutive columns and consecutive rows alternate.
/// An axis of one periodic cell touches itself only.
inline int neighbourhood_colour(int column, int row, int columns, int rows, bool is_periodic) {
  auto const along = [is_periodic](int index, int count) {
    bool const closes_an_odd_ring = is_periodic && count % 2 == 1 && count > 1 && index == count - 1;
    return closes_an_odd_ring ? 2 : index % 2;
  };
  return along(column, columns) + 3 * along(row, rows);
}

}  // namespace gridlock
