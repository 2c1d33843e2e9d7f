#include "packed_turns.hpp"

#include <array>

#include "engine/headings.hpp"

namespace gridlock {

void take_batch_scalar(PackedTurns& turns, TurnsInOrder const& order, std::size_t first, std::size_t count) {
  // All turns are prepared before the first is taken, so that the processor does not wait for the memory of each.
  std::array<PackedTurns::Prepared, PackedTurns::largest_batch> prepared;
  std::array<TurnResult*, PackedTurns::largest_batch> result_of;
  std::size_t local = 0;
  TurnView const& view = turns.constants().view;
  for (std::size_t l = first; l < first + count; ++l) {
    std::uint32_t const i = order.rows[l];
    if (view.is_propelled()) {
      view.disks[i].velocity = turned_velocity(*view.heading, view.disks[i].id_index, view.disks[i].velocity);
    }
    if (turns.is_local(i, squared_length(view.disks[i].velocity))) {
      prepared[local] = turns.prepare(i, *order.blocks[l], order.slots[l]);
      result_of[local++] = &order.result_of(l);
    } else {
      order.result_of(l).not_local.push_back(i);
    }
  }
  for (std::size_t n = 0; n < local; ++n) turns.take(prepared[n], result_of[n]->counters);
}

}  // namespace gridlock
