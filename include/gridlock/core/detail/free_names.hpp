#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// The Ids that the next newborns of a population get; see Id for slots.
class FreeNames {
 public:
  FreeNames() = default;
  /// The Ids of the first `slots` slots are taken, except those in `free`; take() returns the last of `free` first.
  FreeNames(std::uint64_t slots, std::vector<std::uint64_t> free) : slots_(slots), free_(std::move(free)) {}

  /// Returns the Id of a newborn.
  [[nodiscard]] std::uint64_t take() {
    if (free_.empty()) return slots_++;
    std::uint64_t const id = free_.back();
    free_.pop_back();
    return id;
  }
  /// Frees the slot of a dead agent: its next agent gets another Id.
  void give_back(std::uint64_t id) { free_.push_back(id + next_generation); }

  /// Returns the number of slots that have been used.
  [[nodiscard]] std::uint64_t slots() const { return slots_; }
  [[nodiscard]] std::vector<std::uint64_t> const& free() const { return free_; }

  void serialize(Archive& archive) {
    archive.visit("slots", slots_);
    archive.visit("free_name", free_);
  }

 private:
  static constexpr std::uint64_t next_generation = std::uint64_t{1} << 32;

  std::uint64_t slots_ = 0;
  std::vector<std::uint64_t> free_;
};

}  // namespace gridlock
