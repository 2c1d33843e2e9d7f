#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridlock/core/box.hpp"

namespace gridlock {

/// Rows first … end − 1.
struct RowRange {
  std::size_t first;
  std::size_t end;
};

/// Who among agents in ranges of rows is nearer to a point than some cutoff.
struct RowSearch {
  double const* x;  ///< the columns
  double const* y;
  std::size_t size;  ///< of the columns; behind a range rows may be read that do not count
  Vector p;
  double squared_cutoff;
  std::size_t left_out;  ///< the row that is not to be found, that of the agent itself
  Box const* box =
      nullptr;  ///< where images matter: none away from the edges, where the nearest one is the agent itself
};

/// Room that a search needs behind the rows it may find.
constexpr std::size_t neighbour_slack = 8;

/// Writes the rows that are near to `found`, in the order of the ranges, and returns how many there are.
///
/// Which candidate is near is as good as random, so that no branch depends on it: eight are looked at at a time with
/// AVX-512 or AVX2, four with SSE4 or NEON, chosen at run time; the same rows with any.
/// Cost: about 10 ns for six neighbours among seventeen candidates in three ranges.
/// Contract: room for all candidates and neighbour_slack more; rows are below 2³².
std::size_t find_neighbours(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found);

}  // namespace gridlock
