#include "grid/sorted_pairs.hpp"

#include <algorithm>
#include <array>

namespace gridlock {

namespace {

template <class Displacement>
void add_pairs(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, PairBuffer& buffer,
               Displacement displacement) {
  for (std::size_t row = cell.first; row < cell.end; ++row) {
    Vector const p{rows.x[row], rows.y[row]};
    PairBuffer::Pair* pair = buffer.room_for(max_candidates);
    for (RowRange const& range : ranges) {
      for (std::size_t other = &range == ranges.data() ? row + 1 : range.first; other < range.end; ++other) {
        // Every candidate is written; only the end depends on the comparison.
        *pair = {rows.index[row], rows.index[other]};
        Vector const q{rows.x[other], rows.y[other]};
        pair += squared_length(displacement(p, q)) < rows.squared_cutoff ? 1 : 0;
      }
    }
    buffer.keep_until(pair);
  }
}

/// Adds the near pairs of a row with a range of rows of any length.
void add_pairs_of_row(SortedRows const& rows, std::size_t row, RowRange range, Box const* box, AddPairsOfRows add_pairs,
                      PairBuffer& buffer) {
  for (std::size_t first = range.first; first < range.end; first += max_candidates) {
    RowRange const cell{row, row + 1};
    std::array const ranges{cell, RowRange{first, std::min(range.end, first + max_candidates)}};
    add_pairs(rows, cell, ranges, box, buffer);
  }
}

}  // namespace

void add_pairs_of_rows_scalar(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, Box const* box,
                              PairBuffer& buffer) {
  if (box == nullptr) {
    add_pairs(rows, cell, ranges, buffer, [](Vector p, Vector q) { return q - p; });
  } else {
    add_pairs(rows, cell, ranges, buffer,
              [inside = *box](Vector p, Vector q) { return inside.displacement_inside(p, q); });
  }
}

AddPairsOfRows add_pairs_of_rows_kernel(Target target) {
#ifdef GRIDLOCK_HIGHWAY
  if (AddPairsOfRows const kernel = add_pairs_of_rows_with_highway(target)) return kernel;
#endif
  static_cast<void>(target);
  return add_pairs_of_rows_scalar;
}

void add_pairs_of_cells(CellList const& points, Box const& box, double squared_cutoff, int first_row, int end_row,
                        PairBuffer& buffer) {
  static AddPairsOfRows const add_pairs = add_pairs_of_rows_kernel(target());
  auto const blocks = points.blocks();
  SortedRows const sorted{.x = points.x(),
                          .y = points.y(),
                          .index = points.indices().data(),
                          .size = points.size(),
                          .squared_cutoff = squared_cutoff};
  if (!blocks.has_halves()) {
    points.for_each_cell(first_row, end_row, [&](int column, int cell_row, RowRange cell) {
      RowBlock const block = blocks.around(column, cell_row);
      for (std::size_t row = cell.first; row < cell.end; ++row) {
        // Pairs are found at the row that comes first.
        for (RowRange const range : block.ranges()) {
          add_pairs_of_row(sorted, row, {std::max(range.first, row + 1), range.end}, &box, add_pairs, buffer);
        }
      }
    });
    return;
  }
  points.for_each_cell(first_row, end_row, [&](int column, int cell_row, RowRange cell) {
    RowBlock const block = blocks.after(column, cell_row);
    Box const* const images = block.is_at_edge ? &box : nullptr;
    if (block.candidates <= max_candidates) [[likely]] {
      add_pairs(sorted, cell, block.ranges(), images, buffer);
      return;
    }
    for (std::size_t row = cell.first; row < cell.end; ++row) {
      for (RowRange const& range : block.ranges()) {
        std::size_t const first = &range == block.rows.data() ? row + 1 : range.first;
        add_pairs_of_row(sorted, row, {first, range.end}, images, add_pairs, buffer);
      }
    }
  });
}

}  // namespace gridlock
