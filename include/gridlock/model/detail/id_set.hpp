#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/population.hpp"

namespace gridlock {

/// A set of few Ids with a fast contains(), which is called for many agents.
class IdSet {
 public:
  /// Sorts the Ids, and drops repeats.
  explicit IdSet(std::vector<Id> ids);

  [[nodiscard]] std::span<Id const> sorted() const { return ids_; }
  [[nodiscard]] bool contains(Id id) const {
    std::uint64_t const bit = id & mask_;
    return (bits_[bit / 64] >> bit % 64 & 1U) != 0 && is_among(id);
  }

 private:
  [[nodiscard]] bool is_among(Id id) const;

  std::vector<Id> ids_;
  std::uint64_t mask_ = 63;
  std::vector<std::uint64_t> bits_;  ///< a bit for each value of the last bits of an Id: clear if no Id of the set has
                                     ///< them
};

}  // namespace gridlock
