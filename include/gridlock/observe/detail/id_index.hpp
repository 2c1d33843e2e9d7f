#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/core/detail/large_array.hpp"
#include "gridlock/core/population.hpp"

namespace gridlock {

/// An index of the agents alive at one time: each has a place, its position in the order of the Ids. It finds values
/// stored then for agents whose rows have changed since.
/// Cost: one comparison if the Ids have no gaps or the row has not changed, else O(log N). Memory: 8 bytes an agent, or
/// none if the Ids have no gaps, as at a start; 4 bytes an agent more if the rows were not in the order of the Ids.
class IdIndex {
 public:
  static constexpr std::size_t not_found = static_cast<std::size_t>(-1);

  IdIndex() = default;
  explicit IdIndex(std::span<Id const> ids);

  [[nodiscard]] std::size_t size() const { return size_; }

  /// Returns the place of the agent that is in `row` now, or `not_found` if it was not alive then.
  [[nodiscard]] std::size_t place_of(Id id, std::size_t row) const {
    if (sorted_.empty()) return id - first_ < size_ ? static_cast<std::size_t>(id - first_) : not_found;
    return row < size_ && sorted_[row] == id ? row : search(id);
  }

  /// Returns the number of agents with a lower Id.
  [[nodiscard]] std::size_t count_below(Id id) const;

  [[nodiscard]] Id id_at(std::size_t place) const { return sorted_.empty() ? first_ + place : sorted_[place]; }

  /// Returns the place of the agent that was in a row when the index was made.
  [[nodiscard]] std::size_t place_of_row(std::size_t row) const {
    return place_of_row_.empty() ? row : place_of_row_[row];
  }

  /// Serializes the Ids in the order of the rows when the index was made.
  void serialize(Archive& archive);

 private:
  [[nodiscard]] std::size_t search(Id id) const;

  Id first_ = 0;
  std::size_t size_ = 0;
  LargeArray<Id> sorted_;                    ///< empty if the Ids are first_, first_ + 1, …
  std::vector<std::uint32_t> place_of_row_;  ///< empty if the rows were in the order of the Ids
};

}  // namespace gridlock
