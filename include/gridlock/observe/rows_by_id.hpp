#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "gridlock/core/population.hpp"

namespace gridlock {

/// The agents alive at one moment, each with a fixed place in Id order, so that what was noted then can be compared
/// with rows that have been reordered, born or removed since.
/// Cost: one comparison to find a row that still stands in its place, O(log N) otherwise. Memory: 8 bytes an agent.
class RowsById {
 public:
  static constexpr std::size_t not_found = static_cast<std::size_t>(-1);

  RowsById() = default;
  explicit RowsById(std::span<Id const> ids);

  [[nodiscard]] std::size_t size() const { return sorted_.size(); }

  /// The place of the agent that now stands in `row`, or `not_found` for one that was not there.
  [[nodiscard]] std::size_t place_of(Id id, std::size_t row) const {
    return row < sorted_.size() && sorted_[row] == id ? row : search(id);
  }

  /// Which of `blocks` runs of neighbouring Ids, equal in size to one agent, a place belongs to.
  [[nodiscard]] std::size_t block_of(std::size_t place, std::size_t blocks) const {
    return place * blocks / sorted_.size();
  }

  void carry(Archive& archive) {
    archive.visit("ids", sorted_);
    archive.require(std::ranges::is_sorted(sorted_), "the names are not in order");
  }

 private:
  [[nodiscard]] std::size_t search(Id id) const;

  std::vector<Id> sorted_;
};

}  // namespace gridlock
