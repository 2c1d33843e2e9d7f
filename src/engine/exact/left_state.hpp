#pragma once

#include <cstdint>

#include "gridlock/core/disks.hpp"

namespace gridlock::exact {

/// A fingerprint of the state given to the caller. The engine may continue its flight only while the state is
/// unchanged.
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
  /// Returns a hash of the Ids in the order of the rows, because hash(State) does not depend on that order.
  static std::uint64_t hash_of_rows(Disks const& disks) {
    std::uint64_t hash = 0;
    for (Id const id : disks.ids()) hash = (hash ^ id) * 0x9E3779B97F4A7C15U;
    return hash;
  }

  std::uint64_t hash_ = 0;
  std::uint64_t row_hash_ = 0;
};

}  // namespace gridlock::exact
