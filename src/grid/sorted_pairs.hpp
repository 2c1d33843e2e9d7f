#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "grid/candidate_pairs.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/target.hpp"
#include "gridlock/grid/detail/cell_list.hpp"
#include "gridlock/grid/detail/find_neighbours.hpp"

namespace gridlock {

/// Points in the order of their cells, and the distance within which a pair is near. A row here is the index of a point
/// in this order; cells have rows of their own.
struct SortedRows {
  double const* x;
  double const* y;
  std::uint32_t const* index;  ///< index of each agent
  std::size_t size;
  double squared_cutoff;
};

/// Largest number of candidates of a row that a kernel takes at once.
constexpr std::size_t max_candidates = 512;
static_assert(max_candidates <= PairBuffer::capacity);

/// A kernel. For each row of a cell it adds the near pairs with the rows behind it in the first range, which begins
/// with the cell, and with all rows of the other ranges, in the order of the ranges. `box` is as in RowSearch.
/// Contract: the ranges have at most max_candidates rows.
using AddPairsOfRows = void (*)(SortedRows const&, RowRange cell, std::span<RowRange const> ranges, Box const* box,
                                PairBuffer&);

/// Returns the kernel for these instructions, or for the next simpler ones that have a kernel. All add the same pairs
/// in the same order, as a test verifies. Contract: is_available(target).
AddPairsOfRows add_pairs_of_rows_kernel(Target target);

void add_pairs_of_rows_scalar(SortedRows const& rows, RowRange cell, std::span<RowRange const> ranges, Box const* box,
                              PairBuffer& buffer);

/// Adds all pairs of points with |separation|² < squared_cutoff whose first point is in rows first_row … end_row − 1 of
/// cells. Contract: the cutoff is at most the shorter side of a cell.
void add_pairs_of_cells(CellList const& points, Box const& box, double squared_cutoff, int first_row, int end_row,
                        PairBuffer& buffer);

/// Returns the kernel written with Highway, or nullptr where it has none for these instructions.
AddPairsOfRows add_pairs_of_rows_with_highway(Target target);

}  // namespace gridlock
