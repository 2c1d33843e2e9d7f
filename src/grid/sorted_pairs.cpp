#include "grid/sorted_pairs.hpp"

namespace gridlock {

namespace {

template <class Displacement>
void add_pairs(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, PairBuffer& buffer,
               Displacement displacement) {
  for (std::size_t row = cell.first; row < cell.end; ++row) {
    Vector const p{rows.x[row], rows.y[row]};
    PairBuffer::Pair* pair = buffer.room_for(most_candidates);
    for (RowRange const& range : ranges) {
      for (std::size_t other = &range == ranges.data() ? row + 1 : range.first; other < range.end; ++other) {
        // Every candidate is written, and only the count depends on the answer.
        *pair = {rows.index[row], rows.index[other]};
        Vector const q{rows.x[other], rows.y[other]};
        pair += squared_length(displacement(p, q)) < rows.squared_cutoff ? 1 : 0;
      }
    }
    buffer.keep_until(pair);
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

}  // namespace gridlock
