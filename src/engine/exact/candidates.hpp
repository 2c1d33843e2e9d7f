#pragma once

// The candidates of a disk by Index; every kernel but the reference kernel uses this file.

#include <algorithm>
#include <bit>
#include <cstddef>

#include "engine/exact/prediction.hpp"

namespace gridlock::exact {

/// Largest number of slots per cell for which kernels read whole rows. Cells have more where disks are much smaller
/// than the largest; then candidates are collected one by one.
inline constexpr std::size_t slots_per_cell = 4;
/// Candidates in a batch, for any width of register. Few disks have more, so processors guess the end of a loop right.
inline constexpr std::size_t batch = 8;
/// Largest number of candidates: nine full cells, rounded up to whole batches.
inline constexpr std::size_t max_candidates = 40;

/// The candidates of a disk, without gaps; the Index `nobody` fills the last batch.
struct Candidates {
  alignas(64) Index disks[max_candidates + batch];
  std::size_t count;
};

// A disk that has just collided is excluded from its partner's candidates by Index, not by a mark in its record: a
// record that was just written number by number and is read as a whole makes the processor wait.

/// Returns the first slot of the 3×3 block of cells around disk i.
inline Index const* first_slot_around(PredictionInput const& s, Index i) {
  Cell const cell = s.cells[i];
  return s.slots + static_cast<std::size_t>(cell.row) * s.row_stride +
         static_cast<std::size_t>(cell.column) * s.capacity;
}

/// Returns the first event among `best` and the contacts of disk i with any number of candidates but `apart`.
/// earliest_of(candidates, best) handles one batch of candidates after the other.
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
        // The used slots of a cell are the first ones.
        for (std::size_t k = 0; k < s.capacity && cell[k] != no_disk; ++k) consider(cell[k]);
      }
    }
  }
  if (part.count > 0) look();
  return best;
}

/// Returns the first event among `best` and the contacts at time `earliest` in the lanes of `firsts`; ties go to the
/// lower Id.
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
  // A processor cannot guess which of the two is earlier, and after a wrong guess it would start the next prediction
  // late. So no branch may depend on it; compilers make none of operations on bits.
  Index const other = names[std::countr_zero(firsts | 0x80U)];
  Index const is_other = 0U - static_cast<Index>(earliest < best.time);
  return {std::min(earliest, best.time), best.partner ^ ((best.partner ^ other) & is_other)};
}

}  // namespace gridlock::exact
