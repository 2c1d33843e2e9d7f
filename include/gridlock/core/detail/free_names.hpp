#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "gridlock/core/archive.hpp"

namespace gridlock {

/// The names that the next newborn of a population get, without its agents: see Id.
class FreeNames {
 public:
  FreeNames() = default;
  /// `slots` have been used; of these the ones of `free` are not, the one that is taken next last.
  FreeNames(std::uint64_t slots, std::vector<std::uint64_t> free) : slots_(slots), free_(std::move(free)) {}

  /// The name of a newborn.
  [[nodiscard]] std::uint64_t take() {
    if (free_.empty()) return slots_++;
    std::uint64_t const id = free_.back();
    free_.pop_back();
    return id;
  }
  /// An agent has died.
  void give_back(std::uint64_t id) { free_.push_back(id + next_generation); }

  /// Names are the numbers of slots and, in the high 32 bits, how often a slot was used before.
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
