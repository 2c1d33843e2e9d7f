#pragma once

// Shared by every predictor but the reference: the candidates of a disk by name.

#include <algorithm>
#include <bit>
#include <cstddef>

#include "engine/exact/prediction.hpp"

namespace gridlock::exact {

/// Where cells have more slots, because disks are so much smaller than the largest, all candidates are collected one by
/// one.
inline constexpr std::size_t slots_per_cell = 4;
/// Candidates are looked at so many at a time, whatever the registers: few disks have more, so that processors guess
/// well how often a loop turns.
inline constexpr std::size_t batch = 8;
/// Those of nine full cells, rounded up.
inline constexpr std::size_t max_candidates = 40;

/// The disks around a disk, moved together, and behind them `nobody` up to a full batch.
struct Candidates {
  alignas(64) Index disks[max_candidates + batch];
  std::size_t count;
};

// A disk that has just collided with another is none of its candidates, by name: what was just written, number by
// number, would be read as a whole, and processors wait for that.

/// The first slot of the three rows of cells around a disk.
inline Index const* first_slot_around(PredictionInput const& s, Index i) {
  Cell const cell = s.cells[i];
  return s.slots + static_cast<std::size_t>(cell.row) * s.row_stride +
         static_cast<std::size_t>(cell.column) * s.capacity;
}

/// The first of `best` and the contacts with all that i may meet but for `apart`, however many: earliest_of(candidates,
/// best) looks at a part of them.
template <class EarliestOf>
Prediction earliest_of_many(PredictionInput const& s, Index i, Index apart, Prediction best, EarliestOf earliest_of) {
  Candidates part;
  part.count = 0;
  auto const look = [&] {
    std::fill_n(part.disks + part.count, batch, s.nobody);
    best = earliest_of(part, best);
    part.count = 0;
  };
  auto const consider = [&](Index name) {
    part.disks[part.count] = name;
    part.count += static_cast<std::size_t>((name != i) & (name != apart));
    if (part.count == max_candidates) look();
  };
  if (s.neighbours != nullptr) {
    for (Index const name : s.neighbours_of(i)) consider(name);
  } else {
    Index const* row = first_slot_around(s, i);
    for (int rows = 0; rows < 3; ++rows, row += s.row_stride) {
      for (Index const* cell = row; cell != row + 3 * s.capacity; cell += s.capacity) {
        // The first slots of a cell are the ones in use.
        for (std::size_t k = 0; k < s.capacity && cell[k] != no_disk; ++k) consider(cell[k]);
      }
    }
  }
  if (part.count > 0) look();
  return best;
}

/// The first of `best` and the contacts with these disks that take place at the time `earliest`, in the lanes of
/// `firsts`; ties go to the lower Id.
inline Prediction earlier_of(Prediction const& best, double earliest, unsigned firsts, Index const* names,
                             MovingDisk const* disks) {
  if (((firsts & (firsts - 1U)) != 0) | (earliest == best.time)) [[unlikely]] {
    Prediction first = best;
    for (unsigned rest = firsts; rest != 0; rest &= rest - 1U) {
      Index const j = names[std::countr_zero(rest)];
      bool const is_tie = earliest == first.time && first.partner < vertical_border;
      if (earliest < first.time || (is_tie && disks[j].id_index < disks[first.partner].id_index)) first = {earliest, j};
    }
    return first;
  }
  // Which of the two is earlier is a coin toss: no branch may depend on it, or the processor could not begin with
  // the next prediction meanwhile. Compilers do not make one of bits.
  Index const other = names[std::countr_zero(firsts | 0x80U)];
  Index const is_other = 0U - static_cast<Index>(earliest < best.time);
  return {std::min(earliest, best.time), best.partner ^ ((best.partner ^ other) & is_other)};
}

}  // namespace gridlock::exact
