#include "gridlock/observe/detail/id_index.hpp"

#include <algorithm>
#include <utility>

#include "gridlock/core/detail/rows_in_order.hpp"

namespace gridlock {

IdIndex::IdIndex(std::span<Id const> ids) : size_(ids.size()) {
  LargeArray<Id> sorted(ids.begin(), ids.end());
  if (!std::ranges::is_sorted(ids)) {
    std::vector<std::uint32_t> const rows = rows_in_order(ids);
    place_of_row_.resize(size_);
    for (std::uint32_t place = 0; place < rows.size(); ++place) {
      sorted[place] = ids[rows[place]];
      place_of_row_[rows[place]] = place;
    }
  }
  first_ = sorted.empty() ? 0 : sorted.front();
  bool const has_no_gap = sorted.empty() || sorted.back() - first_ == size_ - 1;
  sorted_ = has_no_gap ? LargeArray<Id>() : std::move(sorted);
}

std::size_t IdIndex::count_below(Id id) const {
  if (sorted_.empty()) return id <= first_ ? 0 : std::min<Id>(id - first_, size_);
  return static_cast<std::size_t>(std::ranges::lower_bound(sorted_, id) - sorted_.begin());
}

std::size_t IdIndex::search(Id id) const {
  auto const found = std::ranges::lower_bound(sorted_, id);
  return found != sorted_.end() && *found == id ? static_cast<std::size_t>(found - sorted_.begin()) : not_found;
}

void IdIndex::serialize(Archive& archive) {
  std::vector<Id> ids(size_);
  for (std::size_t row = 0; row < size_; ++row) ids[row] = id_at(place_of_row(row));
  archive.visit_rows("ids", ids);
  if (!archive.is_restoring()) return;
  std::vector<Id> sorted = ids;
  std::ranges::sort(sorted);
  // With duplicates the constructor, which compares the last Id with the number of Ids, could miss a gap.
  archive.require(std::ranges::adjacent_find(sorted) == sorted.end(), "two agents have one name");
  *this = IdIndex(ids);
}

}  // namespace gridlock
