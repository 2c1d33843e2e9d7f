#include "packed_turns.hpp"

#include <array>

namespace gridlock {

void take_batch_scalar(PackedTurns& turns, std::span<std::uint32_t const> rows, Counters& counters,
                       std::vector<std::uint32_t>& not_local) {
  // All before the first is taken, which keeps the processor from waiting for each.
  std::array<PackedTurns::Prepared, PackedTurns::largest_batch> prepared;
  std::size_t count = 0;
  for (std::uint32_t const i : rows) {
    if (turns.is_local(i, squared_length(turns.constants().view.disks[i].velocity))) {
      prepared[count++] = turns.prepare(i);
    } else {
      not_local.push_back(i);
    }
  }
  for (std::size_t n = 0; n < count; ++n) turns.take(prepared[n], counters);
}

}  // namespace gridlock
