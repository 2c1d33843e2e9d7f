#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock::exact {

/// The state as it was when it was handed to the caller: only as long as it stays so can the flight go on that it was
/// taken from.
class LeftState {
 public:
  void remember(State const& state) {
    hash_ = hash(state);
    row_hash_ = hash_of_rows(state.agents);
  }
  [[nodiscard]] bool is(State const& state) const {
    return hash_of_rows(state.agents) == row_hash_ && hash(state) == hash_;
  }

 private:
  /// Which Id is in which row, which hash(State) leaves out on purpose.
  static std::uint64_t hash_of_rows(Disks const& disks) {
    std::uint64_t hash = 0;
    for (Id const id : disks.ids()) hash = (hash ^ id) * 0x9E3779B97F4A7C15U;
    return hash;
  }

  std::uint64_t hash_ = 0;
  std::uint64_t row_hash_ = 0;
};

}  // namespace gridlock::exact
