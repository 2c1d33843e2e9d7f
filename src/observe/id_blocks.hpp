#pragma once

#include <array>
#include <cstddef>

#include "gridlock/core/population.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Sixteen blocks of neighbouring Ids, of all agents in Id order, equal in size to one agent: the agent in place p of N
/// is in block 16 p / N, rounded down.
class IdBlocks {
 public:
  static constexpr std::size_t count = 16;  ///< a power of two

  IdBlocks() = default;
  /// `index` has the agents of this process; all processes make theirs together. Cost on several: 64 rounds of messages.
  IdBlocks(Snapshot const& now, IdIndex const& index);

  /// The block of an agent in the index.
  [[nodiscard]] std::size_t block_of(Id id) const {
    // Bisection without branches, for Ids in no order.
    std::size_t block = 0;
    for (std::size_t step = count / 2; step > 0; step /= 2) block += first_[block + step] <= id ? step : 0;
    return block;
  }

 private:
  std::array<Id, count> first_{};  ///< the first Id of each block
};

}  // namespace gridlock
