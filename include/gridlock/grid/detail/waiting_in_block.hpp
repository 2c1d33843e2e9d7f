#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "gridlock/grid/detail/packed_grid.hpp"

namespace gridlock {

/// The marks of a block as ClassOrder uses them, and tables indexed by them. Tables replace branches on which agents
/// wait and on the order of Ids, since the processor could not predict them.
///
///     bits of marks    0 … 3                      4 … 10                       15
///                      set if the agent waits,    code of the number of        `changed`: the code must be
///                      by the mark of the step    agents and order of Ids      found anew
struct WaitingInBlock {
  static constexpr unsigned slots = PackedGrid::slots;
  static constexpr unsigned all_slots = (1U << slots) - 1U;
  static constexpr unsigned orders = 24;  ///< number of orders of four slots
  static constexpr unsigned bits_of_slot = 2;
  static constexpr unsigned mask_of_slot = (1U << bits_of_slot) - 1U;
  static constexpr unsigned first_bit_of_count = slots * bits_of_slot;
  static constexpr unsigned more_than_two = 1U << 13;
  static constexpr unsigned any = 1U << 14;
  static constexpr unsigned several = 1U << 15;

  /// The code in the marks, by the number of agents and the slots in the order of Ids (two bits each).
  std::array<std::array<std::uint16_t, 1U << first_bit_of_count>, slots + 1> code{};
  /// By marks in which bit s is set if the agent in slot s waits: the slots of the waiting agents in the order of Ids
  /// (two bits each), their number, and bits for a number above 0, 1 and 2.
  std::array<std::uint16_t, ((slots + 1) * orders) << slots> waiting{};

  constexpr WaitingInBlock() {
    std::array<unsigned, slots> order{0, 1, 2, 3};
    for (unsigned k = 0; k < orders; ++k, std::next_permutation(order.begin(), order.end())) {
      unsigned sequence = 0;
      for (unsigned n = 0; n < slots; ++n) sequence |= order[n] << (bits_of_slot * n);
      for (unsigned count = 0; count <= slots; ++count) {
        unsigned const first = (count * orders + k) << slots;
        code[count][sequence] = static_cast<std::uint16_t>(first);
        for (unsigned set = 0; set <= all_slots; ++set) waiting[first + set] = waiting_of(order, count, set);
      }
    }
  }

  static constexpr unsigned slot(unsigned waiting, unsigned n) { return waiting >> (bits_of_slot * n) & mask_of_slot; }
  static constexpr unsigned count(unsigned waiting) { return waiting >> first_bit_of_count & 0xfU; }

 private:
  static constexpr std::uint16_t waiting_of(std::array<unsigned, slots> const& order, unsigned count, unsigned set) {
    unsigned found = 0;
    unsigned size = 0;
    for (unsigned const slot : order) {
      if (slot < count && (set >> slot & 1U) != 0) found |= slot << (bits_of_slot * size++);
    }
    return static_cast<std::uint16_t>(found | size << first_bit_of_count | (size > 2 ? more_than_two : 0U) |
                                      (size > 0 ? any : 0U) | (size > 1 ? several : 0U));
  }
};
inline constexpr WaitingInBlock waiting_in_block;

/// Writes the code of the order of Ids (or of numbers in the same order) to the marks of a block, the only one of its
/// cell. No branch depends on the Ids, since the processor could not predict it.
template <class IdOf>
[[gnu::noinline]] void note_order_of_ids(PackedGrid::Block& block, IdOf id_of) {
  // Empty slots get the largest numbers, so that they come last.
  std::array<std::uint64_t, PackedGrid::slots> id;
  for (unsigned s = 0; s < PackedGrid::slots; ++s) {
    bool const is_taken = s < block.count;
    // The row in an empty slot is not read, since it may be far away in memory.
    std::uint64_t const id_taken = id_of(block.agent[is_taken ? s : 0]);
    id[s] = is_taken ? id_taken : std::numeric_limits<std::uint64_t>::max() - PackedGrid::slots + s;
  }
  auto const is_less = [&](unsigned a, unsigned b) { return id[a] < id[b] ? 1U : 0U; };
  unsigned const less_01 = is_less(0, 1);
  unsigned const less_02 = is_less(0, 2);
  unsigned const less_03 = is_less(0, 3);
  unsigned const less_12 = is_less(1, 2);
  unsigned const less_13 = is_less(1, 3);
  unsigned const less_23 = is_less(2, 3);
  // Slot 0 needs no term: its two bits are 0 at the remaining place.
  auto const at = [](unsigned slot, unsigned place) { return slot << (WaitingInBlock::bits_of_slot * place); };
  unsigned const order = at(1, 2 + less_01 - less_12 - less_13) | at(2, 1 + less_02 + less_12 - less_23) |
                         at(3, less_03 + less_13 + less_23);
  block.marks =
      static_cast<std::uint16_t>((block.marks & WaitingInBlock::all_slots) | waiting_in_block.code[block.count][order]);
}

}  // namespace gridlock
