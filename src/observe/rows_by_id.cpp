#include "gridlock/observe/rows_by_id.hpp"

#include <algorithm>

namespace gridlock {

RowsById::RowsById(std::span<Id const> ids) : sorted_(ids.begin(), ids.end()) { std::ranges::sort(sorted_); }

std::size_t RowsById::search(Id id) const {
  auto const found = std::ranges::lower_bound(sorted_, id);
  return found != sorted_.end() && *found == id ? static_cast<std::size_t>(found - sorted_.begin()) : not_found;
}

}  // namespace gridlock
