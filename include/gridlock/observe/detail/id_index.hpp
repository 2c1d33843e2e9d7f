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

/// The agents alive at one time, each with a fixed place in Id order, so that what was noted then can be compared
/// with rows that have been reordered, born or removed since.
/// Cost: one comparison where the Ids follow one another without a gap or a row is still in its place, O(log N)
/// otherwise. Memory: 8 bytes an agent, none where the Ids follow one another, as those of a start do; 4 bytes an agent
/// more where the rows were not in Id order.
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

  /// How many of the agents have a lower Id.
  [[nodiscard]] std::size_t count_below(Id id) const;

  [[nodiscard]] Id id_at(std::size_t place) const { return sorted_.empty() ? first_ + place : sorted_[place]; }

  /// The place of the agent that was in a row then.
  [[nodiscard]] std::size_t place_of_row(std::size_t row) const {
    return place_of_row_.empty() ? row : place_of_row_[row];
  }

  /// One Id for each row of then, in the order of the rows.
  void serialize(Archive& archive);

 private:
  [[nodiscard]] std::size_t search(Id id) const;

  Id first_ = 0;
  std::size_t size_ = 0;
  LargeArray<Id> sorted_;                    ///< empty where the Ids are first_, first_ + 1, …
  std::vector<std::uint32_t> place_of_row_;  ///< empty where the rows were in Id order
};

}  // namespace gridlock
