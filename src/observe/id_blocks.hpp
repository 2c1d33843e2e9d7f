#pragma once

#include <array>
#include <cstddef>

#include "gridlock/core/population.hpp"
#include "gridlock/observe/detail/id_index.hpp"
#include "gridlock/observe/observable.hpp"

namespace gridlock {

/// Sixteen blocks of agents with neighbouring Ids, equal in size up to one agent: agent number p of N in the order of
/// the Ids is in block 16 p / N, rounded down.
class IdBlocks {
 public:
  static constexpr std::size_t count = 16;  ///< a power of two

  IdBlocks() = default;
  /// Makes the blocks from the agents of this process; all processes call it. Cost with several: 64 rounds of messages.
  IdBlocks(Snapshot const& now, IdIndex const& index);

  /// Returns the block of an agent.
  [[nodiscard]] std::size_t block_of(Id id) const {
    // A bisection without branches, because Ids come in no order.
    std::size_t block = 0;
    for (std::size_t step = count / 2; step > 0; step /= 2) block += first_[block + step] <= id ? step : 0;
    return block;
  }

 private:
  std::array<Id, count> first_{};  ///< first Id of each block
};

}  // namespace gridlock
