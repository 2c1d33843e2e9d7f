#pragma once

#include <cstdint>
#include <vector>

#include "gridlock/core/detail/rows_in_order.hpp"
#include "gridlock/core/disks.hpp"

namespace gridlock::exact {

/// Returns the rows of the disks that move in the order of their Ids: the row of each id index.
inline std::vector<std::uint32_t> moving_rows(Disks const& disks) {
  std::vector<std::uint32_t> rows = rows_in_order(disks.ids());
  std::erase_if(rows, [&](std::uint32_t row) { return is_fixed(disks, row); });
  return rows;
}

}  // namespace gridlock::exact
