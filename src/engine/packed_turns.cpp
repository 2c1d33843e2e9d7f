#include "packed_turns.hpp"

#include <array>

namespace gridlock {

void take_batch_scalar(PackedTurns& turns, std::span<std::uint32_t const> rows, ResultsOfTurns results) {
  // All before the first is taken, which keeps the processor from waiting for each.
  std::array<PackedTurns::Prepared, PackedTurns::largest_batch> prepared;
  std::array<TurnResult*, PackedTurns::largest_batch> result_of;
  std::size_t count = 0;
  for (std::size_t l = 0; l < rows.size(); ++l) {
    std::uint32_t const i = rows[l];
    if (turns.is_local(i, squared_length(turns.constants().view.disks[i].velocity))) {
      prepared[count] = turns.prepare(i);
      result_of[count++] = &results.of(l);
    } else {
      results.of(l).not_local.push_back(i);
    }
  }
  for (std::size_t n = 0; n < count; ++n) turns.take(prepared[n], result_of[n]->counters);
}

}  // namespace gridlock
