#pragma once

namespace gridlock {

/// Number of colours that neighbourhood_colour() uses.
inline constexpr int neighbourhood_colours = 9;

/// Returns the colour of a cell, which differs from the colours of its eight neighbours.
///
///     0 1 0 1        three colours along an axis where a periodic edge        0 1 2
///     3 4 3 4        connects an odd number of cells                          3 4 5
///     0 1 0 1                                                                 6 7 8
///
/// Adjacent cells differ by one in column or row, so alternating colours along columns and rows suffice. A periodic
/// axis with a single cell has no other cell to differ from.
inline int neighbourhood_colour(int column, int row, int columns, int rows, bool is_periodic_x, bool is_periodic_y) {
  auto const along = [](int index, int count, bool is_periodic) {
    bool const closes_an_odd_ring = is_periodic && count % 2 == 1 && count > 1 && index == count - 1;
    return closes_an_odd_ring ? 2 : index % 2;
  };
  return along(column, columns, is_periodic_x) + 3 * along(row, rows, is_periodic_y);
}

}  // namespace gridlock
