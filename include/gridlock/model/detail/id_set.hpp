#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/population.hpp"

namespace gridlock {

/// A set of Ids, to ask for each of many agents whether it is one of a few.
class IdSet {
 public:
  /// Sorts them, and drops repeats.
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
  std::vector<std::uint64_t> bits_;  ///< most Ids are told from all others by their last bits
};

}  // namespace gridlock
