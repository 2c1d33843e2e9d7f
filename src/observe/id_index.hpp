#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/core/population.hpp"

namespace gridlock {

/// The agents alive at one time, each with a fixed place in Id order, so that what was noted then can be compared
/// with rows that have been reordered, born or removed since.
/// Cost: one comparison where the Ids follow one another without a gap or a row is still in its place, O(log N)
/// otherwise. Memory: 8 bytes an agent, none where the Ids follow one another, as those of a start do.
class IdIndex {
 public:
  static constexpr std::size_t not_found = static_cast<std::size_t>(-1);

  IdIndex() = default;
  explicit IdIndex(std::span<Id const> ids);

  [[nodiscard]] std::size_t size() const { return size_; }

  /// The place of the agent that is in `row` now, or `not_found` for one that was not there.
  [[nodiscard]] std::size_t place_of(Id id, std::size_t row) const {
    if (sorted_.empty()) return id - first_ < size_ ? static_cast<std::size_t>(id - first_) : not_found;
    return row < size_ && sorted_[row] == id ? row : search(id);
  }

  /// Which of `blocks` runs of neighbouring Ids, equal in size to one agent, a place belongs to.
  [[nodiscard]] std::size_t block_of(std::size_t place, std::size_t blocks) const { return place * blocks / size_; }

  void serialize(Archive& archive);

 private:
  void take(std::vector<Id>&& sorted);
  [[nodiscard]] std::size_t search(Id id) const;

  Id first_ = 0;
  std::size_t size_ = 0;
  std::vector<Id> sorted_;  ///< empty where the Ids are first_, first_ + 1, …
};

}  // namespace gridlock
