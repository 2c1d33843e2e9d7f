#include "gridlock/model/detail/id_set.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/sorted.hpp"

namespace gridlock {

IdSet::IdSet(std::vector<Id> ids) : ids_(std::move(ids)) {
  sort_and_drop_repeats(ids_);
  mask_ = std::bit_ceil(std::max<std::uint64_t>(64, 16 * ids_.size())) - 1;
  bits_.assign((mask_ + 1) / 64, 0);
  for (Id const id : ids_) bits_[(id & mask_) / 64] |= std::uint64_t{1} << (id & mask_) % 64;
}

bool IdSet::is_among(Id id) const { return std::ranges::binary_search(ids_, id); }

}  // namespace gridlock
