#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "gridlock/core/box.hpp"

namespace gridlock {

struct RowRange {
  std::size_t first;
  std::size_t end;
};

/// A search for the agents in some rows that are nearer to a point than a cutoff.
struct RowSearch {
  double const* x;  ///< coordinates of all rows
  double const* y;
  std::size_t size;  ///< number of rows; rows behind a range may be read, but are not found
  Vector p;
  double squared_cutoff;
  std::size_t left_out;      ///< the row of the searching agent, which is not to be found
  Box const* box = nullptr;  ///< nullptr if all candidates are on this side of periodic edges
};

/// Entries that find_neighbours() may write behind the rows it finds.
constexpr std::size_t neighbour_slack = 8;

/// Writes the rows nearer than the cutoff to `found`, in the order of the ranges, and returns their number.
///
/// No branch depends on whether a candidate is near, since the processor could not predict it. Eight candidates are
/// tested at a time with AVX-512 or AVX2, four with SSE4 or NEON; the rows found are the same.
/// Cost: about 10 ns for six neighbours among seventeen candidates in three ranges.
/// Contract: `found` has room for all candidates and neighbour_slack more; rows are below 2³².
std::size_t find_neighbours(RowSearch const& search, std::span<RowRange const> ranges, std::uint32_t* found);

}  // namespace gridlock
