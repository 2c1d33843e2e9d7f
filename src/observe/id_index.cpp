#include "observe/id_index.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace gridlock {

IdIndex::IdIndex(std::span<Id const> ids) {
  std::vector<Id> sorted(ids.begin(), ids.end());
  std::ranges::sort(sorted);
  take(std::move(sorted));
}

void IdIndex::take(std::vector<Id>&& sorted) {
  size_ = sorted.size();
  first_ = sorted.empty() ? 0 : sorted.front();
  bool const has_no_gap = sorted.empty() || sorted.back() - first_ == size_ - 1;
  sorted_ = has_no_gap ? std::vector<Id>() : std::move(sorted);
}

std::size_t IdIndex::search(Id id) const {
  auto const found = std::ranges::lower_bound(sorted_, id);
  return found != sorted_.end() && *found == id ? static_cast<std::size_t>(found - sorted_.begin()) : not_found;
}

void IdIndex::serialize(Archive& archive) {
  std::vector<Id> ids = sorted_;
  if (ids.empty()) {
    ids.resize(size_);
    std::iota(ids.begin(), ids.end(), first_);
  }
  archive.visit("ids", ids);
  // No Id is given twice either: without gaps the last one would tell another number of Ids.
  archive.require(std::ranges::adjacent_find(ids, std::ranges::greater_equal{}) == ids.end(),
                  "the names are not in order");
  take(std::move(ids));
}

}  // namespace gridlock
